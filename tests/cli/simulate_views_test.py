# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier simulate --poses as a user calls it: views of a camera with depth maps, and what map,
localise and world build make of them.

    simulate_views_test.py PROGRAM [unittest's options]
"""
import csv
import json
import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
LOOK = ['simulate', '--world', 'workshop', '--rig', 'depth.rig.json', '--poses', 'way.csv', '--height-m',
        '1.2']


def pose_row(name, x, y, heading, pitch=0.0):
    """Camera to world (z up) by rows; pitch down."""
    c, s, cp, sp = math.cos(heading), math.sin(heading), math.cos(pitch), math.sin(pitch)
    right, down, ahead = (s, -c, 0), (-sp * c, -sp * s, -cp), (cp * c, cp * s, -sp)
    rows = [[right[i], down[i], ahead[i], (x, y, 0)[i]] for i in range(3)] + [[0, 0, 0, 1]]
    return f'{name},' + ','.join(f'{v:.12g}' for row in rows for v in row)


class SimulatedViews(verb_calls.ProgramCase):
    program = PROGRAM

    def setUp(self):
        super().setUp()
        header = 'image,' + ','.join(f't{i}{j}' for i in range(4) for j in range(4))
        self.way = [(6 + 0.25 * i, 7.5, 0.1 * math.sin(i), 0.2 * math.cos(i)) for i in range(12)]
        (self.folder / 'way.csv').write_text('\n'.join(
            [header, *(pose_row(f'v{i}.png', *pose) for i, pose in enumerate(self.way))]) + '\n')

    def done(self, *words, code=0):
        run = self.run_program(*words)
        self.assertEqual(run.returncode, code, run.stderr)
        return run.stdout

    def refused(self, *words, says):
        run = self.run_program(*words)
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
        self.assertIn(says, run.stderr)
        self.assertFalse((self.folder / 'out.jsonl').exists())

    def views(self, name='out.jsonl'):
        return [json.loads(line) for line in (self.folder / name).read_text().splitlines()]

    def test_views_have_the_poses_and_stand_level(self):
        found = json.loads(self.done(*LOOK, '--source', 'none', '--features', 'out.jsonl', '--json'))
        self.assertEqual(found['views'], 12)
        self.assertGreater(found['lines_median'], 20)
        for view, (x, y, heading, _) in zip(self.views(), self.way):
            for a, b in zip(view['pose'], (x, y, heading)):
                self.assertAlmostEqual(a, b, places=9)
            look = view['looks'][0]
            self.assertEqual(look['mount'], {'height_m': 1.2, 'pitch_rad': 0.0})
            upright = [line for line in look['lines'] if line['kind'] == 'vertical']
            self.assertGreater(len(upright), 5)
            for line in look['lines']:
                self.assertGreater(line['a_m'][2], -0.01)  # nothing below the floor

    def test_every_verb_that_simulates_takes_a_file_of_sources(self):
        (self.folder / 'sources.toml').write_text('[sources]\nedge_loss = 0.4\ncorner_sigma_px = 0.3\n')
        (self.folder / 'commands.csv').write_text('speed_mps,turn_radps,duration_s\n0.5,0,1\n')
        words = ['--source', 'edge_loss=0.4', '--source', 'corner_sigma_px=0.3']
        verbs = {
            'drive': ['drive', '--pose', '10,7.5,0', '--commands', 'commands.csv', '-o'],
            'servo': ['servo', '--trials', '1', '--threads', '1', '-o'],
            'odometry': ['odometry', '--world', 'workshop', '--leg', '2', '-o'],
            'map make': ['map', 'make', '--world', 'workshop', '--spacing-m', '6', '-o'],
            'world view': ['world', 'view', 'workshop', '--poses', '2', '-o'],
        }
        for name, call in verbs.items():
            with self.subTest(verb=name):
                made = []
                for number, given in enumerate(([], ['--sources', 'sources.toml'], words)):
                    output = f'{number}.html' if name == 'world view' else str(number)
                    self.done(*call, output, *given)
                    made.append((self.folder / output).read_bytes())
                    (self.folder / output).unlink()
                self.assertEqual(made[1], made[2])
                self.assertNotEqual(made[0], made[1])
                self.refused(*call, 'out', '--sources', 'none.toml', says='none.toml: cannot be read')
                before = (self.folder / 'sources.toml').read_bytes()
                self.refused(*call, 'sources.toml', '--sources', 'sources.toml', says='is an input')
                self.assertEqual((self.folder / 'sources.toml').read_bytes(), before)
        self.refused('localise', 'none.map', '--features', 'a.jsonl', '--sources', 'sources.toml',
                     says='no robot is simulated')

    def test_sources_are_read_from_a_file_as_a_study_does(self):
        file = self.folder / 'sources.toml'
        file.write_text('[sources]\nedge_loss = 0.3\nmissed = 0.2\n')
        one = ['simulate', '--world', 'workshop', '--rig', 'nominal', '--pose', '6,7.5,0', '--json']
        given = ['--source', 'edge_loss=0.3', '--source', 'missed=0.2']
        plain = self.done(*one)
        by_file = self.done(*one, '--sources', 'sources.toml')
        self.assertEqual(by_file, self.done(*one, *given))
        self.assertNotEqual(by_file, plain)
        # single settings come after the file
        self.assertEqual(self.done(*one, '--sources', 'sources.toml', '--source', 'edge_loss=0.1'),
                         self.done(*one, '--source', 'edge_loss=0.1', '--source', 'missed=0.2'))
        self.done(*LOOK, '--sources', 'sources.toml', '--features', 'out.jsonl')
        self.done(*LOOK, *given, '--features', 'by_words.jsonl')
        self.assertEqual((self.folder / 'out.jsonl').read_bytes(),
                         (self.folder / 'by_words.jsonl').read_bytes())
        (self.folder / 'out.jsonl').unlink()
        views = [*LOOK, '--sources', 'sources.toml', '--features', 'out.jsonl']
        self.refused(*views, '--source', 'none', says='would override --sources')
        self.refused(*LOOK, '--sources', 'sources.toml', '--features', 'sources.toml', says='is an input')
        self.refused(*LOOK, '--sources', 'none.toml', '--features', 'out.jsonl', says='none.toml: cannot be read')
        for text, says in (('[sources]\nedge_los = 0.3\n', 'sources.toml:2: '),
                           ('[sources]\n\nedge_loss = 3\n', 'sources.toml:3: '),
                           ('[sources]\nfile = "a.toml"\n', 'sources.toml:2: sources.file'),
                           ('[study]\n', 'sources.toml:1: '), ('', 'sources'), ('[sources', 'sources.toml:1'),
                           ('[sources]\ncalibration = 1\n', 'which has no pair')):
            file.write_text(text)
            with self.subTest(text):
                self.refused(*views, says=says)
                if 'calibration' not in text:
                    self.refused(*one, '--sources', 'sources.toml', says=says)

    def test_the_same_again_is_the_same_and_trials_differ(self):
        self.done(*LOOK, '--features', 'out.jsonl', '--segments', 'a.segments')
        before = (self.folder / 'out.jsonl').read_bytes()
        self.done(*LOOK, '--features', 'out.jsonl')
        self.assertEqual(before, (self.folder / 'out.jsonl').read_bytes())
        self.done(*LOOK, '--trial', '1', '--features', 'out.jsonl')
        self.assertNotEqual(before, (self.folder / 'out.jsonl').read_bytes())
        # a source that is on leaves the views before it: the first has the same draws alone
        first = (self.folder / 'way.csv').read_text().splitlines()[:2]
        (self.folder / 'way.csv').write_text('\n'.join(first) + '\n')
        self.done(*LOOK, '--features', 'out.jsonl')
        self.assertEqual(before.splitlines()[0], (self.folder / 'out.jsonl').read_bytes().splitlines()[0])

    def test_views_make_a_map_and_find_themselves(self):
        self.done(*LOOK, '--features', 'nodes.jsonl')
        self.done(*LOOK, '--trial', '1', '--features', 'queries.jsonl')
        self.done('map', 'make', '--features', 'nodes.jsonl', '-o', 'way.map')
        run = self.run_program('localise', 'way.map', '--features', 'queries.jsonl', '--method', 'pgh',
                               '-o', 'answers.csv')
        self.assertIn(run.returncode, (0, 3), run.stderr)
        with open(self.folder / 'answers.csv', newline='') as text:
            rows = list(csv.DictReader(text))
        near = sum(row['status'] == 'answered' and float(row['error_m']) < 0.5 for row in rows)
        self.assertGreaterEqual(near, 10)

    def test_a_world_built_of_simulated_segments_is_the_world(self):
        self.done(*LOOK, '--source', 'none', '--source', 'endpoint_sigma_px=0.3', '--features',
                  'out.jsonl', '--segments', 'seen.jsonl')
        found = json.loads(self.done('world', 'build', '--segments', 'seen.jsonl', '--poses', 'way.csv',
                                     '--height-m', '1.2', '-o', 'b.toml', '--lines', 'l.csv', '--json'))
        self.assertGreater(found['lines'], 30)
        seen = json.loads(self.done('simulate', '--world', 'workshop', '--rig', 'nominal', '--pose',
                                    '8,7.5,0', '--source', 'none', '--json'))
        again = json.loads(self.done('simulate', '--world', 'b.toml', '--rig', 'nominal', '--pose',
                                     '8,7.5,0', '--source', 'none', '--json'))
        # nothing hides anything in the built world, so it shows what is there and more
        ends = again['space']['a_m'] + again['space']['b_m']
        wanted = seen['space']['a_m'] + seen['space']['b_m']
        found_again = sum(min(math.dist(end, other) for other in ends) < 0.1 for end in wanted)
        # far lines err too much to be joined, and parts hidden from all poses are missing
        self.assertGreater(found_again, 0.5 * len(wanted))

    def test_bad_input_is_refused(self):
        self.refused(*LOOK, says='--features')
        self.refused('simulate', says='--pose or --poses')
        self.refused(*LOOK, '--pose', '1,2,3', '--features', 'out.jsonl', says='one of both')
        self.refused(*LOOK, '--picture', 'a.svg', '--features', 'out.jsonl', says='--picture')
        self.refused('simulate', '--pose', '10,7.5,0', '--features', 'out.jsonl', says='--features')
        self.refused(*LOOK, '--source', 'calibration=1', '--features', 'out.jsonl', says='calibration')
        self.refused(*LOOK[:3], '--rig', 'nominal', *LOOK[5:], '--features', 'out.jsonl',
                     says='distortion')
        self.refused(*LOOK, '--up', 'q', '--features', 'out.jsonl', says='--up')
        self.refused(*LOOK, '--features', 'way.csv', says='way.csv')
        self.done('world', 'make', '--seed', '3', '-o', 'own.toml')
        world = (self.folder / 'own.toml').read_bytes()
        for words in (['--features', 'own.toml'], ['--features', 'o.jsonl', '--segments', 'own.toml']):
            self.refused('simulate', '--world', 'own.toml', *LOOK[3:], *words, says='own.toml')
            self.assertEqual(world, (self.folder / 'own.toml').read_bytes())
        self.refused(*LOOK[:-1], '-3', '--features', 'out.jsonl', says='above the floor')
        (self.folder / 'way.csv').write_text('image,t00\nv0,1\n')
        self.refused(*LOOK, '--features', 'out.jsonl', says='way.csv')

    def test_poses_outside_of_the_world_are_a_doubt(self):
        rows = (self.folder / 'way.csv').read_text().splitlines()
        (self.folder / 'way.csv').write_text(
            rows[0] + '\n' + pose_row('v.png', 900, 900, 0) + '\n')
        run = self.run_program(*LOOK, '--features', 'out.jsonl')
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn('no reliable line', run.stderr)


if __name__ == '__main__':
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
