# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier map and localise as a user calls them.

    localise_test.py PROGRAM [unittest's options]
"""
import json
import math
import pathlib
import random
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls

PROGRAM = pathlib.Path(sys.argv[1]).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[2]
SIZE = 640


def room(seed):
    """Upright lines around the origin: (x, y, low, high)."""
    chance = random.Random(seed)
    return [(chance.uniform(1.5, 7), chance.uniform(-3, 3), chance.uniform(0, 0.8),
             chance.uniform(1.2, 2.2)) for _ in range(40)]


def view(lines, x=0.0, y=0.0, heading=0.0, **more):
    """What is before a robot at a pose in the room."""
    c, s = math.cos(heading), math.sin(heading)
    seen = []
    for at_x, at_y, low, high in lines:
        dx, dy = at_x - x, at_y - y
        forward, left = c * dx + s * dy, -s * dx + c * dy
        if forward > 1 and abs(left) < 0.5 * forward:
            seen.append({'a_m': [forward, left, low], 'b_m': [forward, left, high],
                         'kind': 'vertical', 'sigma_m': 0.02})
    return {'lines': seen, **more}


def write(file, objects):
    file.write_text(''.join(json.dumps(one) + '\n' for one in objects))


class Localise(verb_calls.ProgramCase):
    program = PROGRAM

    def map_of_rooms(self, *names):
        write(self.folder / 'rooms.jsonl',
              [view(room(i), pose=[20.0 * i, 0, 0]) for i in range(6)])
        self.done('map', 'make', '--features', 'rooms.jsonl', '--rig', 'nominal', '-o', 'rooms.map')

    def test_a_simulated_robot_is_found(self):
        made = self.done('map', 'make', '--world', 'workshop', '--spacing-m', '2', '-o', 'w.map', '--json')
        self.assertEqual(json.loads(made)['file'], 'w.map')
        info = json.loads(self.done('map', 'info', 'w.map', '--json'))
        self.assertEqual(info['nodes'], json.loads(made)['nodes'])
        self.assertGreater(info['lines_median'], 50)
        words = ['localise', 'w.map', '--world', 'workshop', '-n', '12', '--seed', '5', '--json']
        found = json.loads(self.done(*words))
        self.assertEqual(len(found['queries']), 12)
        self.assertEqual(found['success']['queries'], 12)
        self.assertGreaterEqual(found['success']['best_guesses_right'], 8)
        again = json.loads(self.done(*words))
        for result in (found, again):
            for query in result['queries']:
                del query['cpu_ms']
        self.assertEqual(found['queries'], again['queries'])
        other = json.loads(self.done(*words[:-3], '--seed', '6', '--json'))
        self.assertNotEqual(found['queries'][0]['truth'], other['queries'][0]['truth'])

    def test_a_simulated_robot_is_found_on_corners(self):
        make = ['map', 'make', '--world', 'workshop', '--spacing-m', '1', '--json']
        bare = json.loads(self.done(*make, '-o', 'w.map'))
        made = json.loads(self.done(*make, '--corners', '-o', 'c.map'))
        self.assertEqual((bare['corners_mean'], bare['lines_median']), (0, made['lines_median']))
        self.assertGreater(made['corners_mean'], 20)
        words = ['localise', 'c.map', '--world', 'workshop', '-n', '12', '--protocol', 'near_path',
                 '--json']
        found = json.loads(self.done(*words, '--method', 'corners'))
        self.assertGreaterEqual(found['success']['best_guesses_right'], 7)
        of_lines = json.loads(self.done(*words))
        words[1] = 'w.map'
        for one, other in zip(of_lines['queries'], json.loads(self.done(*words))['queries']):
            self.assertEqual((one['status'], one.get('pose')), (other['status'], other.get('pose')))
        self.refused(*words, '--method', 'corners', says='map make --corners')
        self.refused('localise', 'c.map', '--features', 'none.jsonl', '--corners', says='--corners')

    def test_a_program_gets_corners_if_asked(self):
        (self.folder / 'counts.py').write_text(
            'import json, sys\n'
            'for _ in range(json.loads(sys.stdin.readline())["nodes"]): sys.stdin.readline()\n'
            'print(json.dumps({"ready": True}), flush=True)\n'
            'for line in sys.stdin:\n'
            '    query = json.loads(line)\n'
            '    corners = query["looks"][0].get("corners", [])\n'
            '    length = len(corners[0]["descriptor"]) if corners else 0\n'
            '    print(json.dumps({"question": query["question"], "status": "unsure", '
            '"pose": [length, 0, 0], "score": len(corners)}), flush=True)\n')
        self.done('map', 'make', '--world', 'workshop', '--spacing-m', '9', '-o', 'w.map')
        words = ['localise', 'w.map', '--world', 'workshop', '-n', '2', '--method', 'program',
                 '--command', 'python3 counts.py', '--json']
        self.assertEqual(json.loads(self.done(*words, code=3))['queries'][0]['score'], 0)
        query = json.loads(self.done(*words, '--corners', code=3))['queries'][0]
        self.assertGreater(query['score'], 10)
        self.assertEqual(query['pose'][0], 32)

    def test_drives_differ_and_a_map_can_be_extended(self):
        make = ['map', 'make', '--world', 'posts.world.toml', '--spacing-m', '1']
        self.done(*make, '-o', 'a.map')
        self.done(*make, '-o', 'again.map')
        self.done(*make, '--drive', '1', '-o', 'b.map')
        bytes_of = lambda name: (self.folder / name).read_bytes()
        self.assertEqual(bytes_of('a.map'), bytes_of('again.map'))
        self.assertNotEqual(bytes_of('a.map'), bytes_of('b.map'))
        nodes = json.loads(self.done('map', 'info', 'a.map', '--json'))['nodes']
        self.done(*make, '--drive', '1', '--extend', 'a.map')
        self.assertEqual(json.loads(self.done('map', 'info', 'a.map', '--json'))['nodes'], 2 * nodes)
        head = 16
        self.assertEqual(bytes_of('a.map')[head:len(bytes_of('again.map'))],
                         bytes_of('again.map')[head:])

    def test_several_that_extend_one_map_each_add_their_own(self):
        """Views at other places each, so that they can be told apart."""
        views = [json.loads(line) for line in verb_calls.features().splitlines()]
        running = []
        for number in range(1, 7):
            write(self.folder / f'{number}.jsonl',
                  [{**view, 'pose': [view['pose'][0], 100 * number, 0]} for view in views])
            running.append(subprocess.Popen(
                [self.program, 'map', 'make', '--features', f'{number}.jsonl', '--rig', 'nominal',
                 '--extend', 'known.map', '-q'], cwd=self.folder, stdout=subprocess.DEVNULL))
        self.assertEqual([process.wait() for process in running], [0] * 6)
        info = json.loads(self.done('map', 'info', 'known.map', '--json'))
        self.assertEqual((info['nodes'], info['positions']), (35, 35))
        self.assertEqual((info['low_m'], info['high_m']), ([0, 0], [4, 600]))
        self.assertFalse(list(self.folder.glob('.vernier-*')))

    def test_features_of_a_file(self):
        self.map_of_rooms()
        write(self.folder / 'q.jsonl',
              [view(room(i), 0.1, -0.05, 0.06, pose=[20.0 * i + 0.1, -0.05, 0.06]) for i in range(6)])
        out = self.done('localise', 'rooms.map', '--features', 'q.jsonl', '--rig', 'nominal',
                        '-o', 'answers.csv', '--json')
        found = json.loads(out)
        for i, query in enumerate(found['queries']):
            self.assertEqual(query['status'], 'answered', query)
            self.assertLess(query['error_m'], 0.1)
            self.assertLess(abs(query['heading_error_deg']), 3)
            self.assertEqual(query['node'], i)
        rows = (self.folder / 'answers.csv').read_text().splitlines()
        self.assertEqual(rows[0], 'query,status,x_m,y_m,heading_deg,probability,node,error_m')
        self.assertEqual(len(rows), 7)
        self.assertAlmostEqual(float(rows[2].split(',')[2]), 20.1, delta=0.1)

    def test_the_views_that_a_map_was_made_of_are_told(self):
        self.map_of_rooms()
        ask = ['localise', 'rooms.map', '--rig', 'nominal', '--features']
        own = self.run_program(*ask, 'rooms.jsonl')
        self.assertIn('queries are views that the map was made of', own.stderr)
        write(self.folder / 'q.jsonl', [view(room(0), 0.1, pose=[0.1, 0, 0])])
        self.assertNotIn('made of', self.run_program(*ask, 'q.jsonl').stderr)

    def test_truth_of_another_frame_is_a_doubt(self):
        self.map_of_rooms()
        write(self.folder / 'q.jsonl',
              [view(room(i), 0.1, -0.05, 0.06, pose=[20.0 * i + 500, -0.05, 0.06]) for i in range(6)])
        found = json.loads(self.done('localise', 'rooms.map', '--features', 'q.jsonl', '--rig', 'nominal',
                                     '--json', code=3))
        self.assertIn('6 of 6 answers are wrong, where the localiser states', found['doubts'][0])

    def test_several_looks_of_a_file(self):
        self.map_of_rooms()
        turned = view(room(2), 0, 0, 0.3, turn_rad=0.3)
        write(self.folder / 'q.jsonl', [{'looks': [view(room(2), turn_rad=0), turned]}])
        found = json.loads(self.done('localise', 'rooms.map', '--features', 'q.jsonl', '--rig',
                                     'nominal', '--json'))
        self.assertEqual(found['queries'][0]['looks'], 2)
        self.assertAlmostEqual(found['queries'][0]['pose'][0], 40, delta=0.1)

    def test_every_look_needs_the_cameras_of_the_map(self):
        self.map_of_rooms()
        rig = json.loads((self.folder / 'rig.json').read_text())
        ask = ['localise', 'own.map', '--features', 'q.jsonl']
        write(self.folder / 'own.jsonl', [view(room(0), cameras=rig['cameras'], pose=[0, 0, 0])])
        self.done('map', 'make', '--features', 'own.jsonl', '-o', 'own.map')
        first = view(room(0), cameras=rig['cameras'])
        longer = json.loads(json.dumps(rig['cameras']))
        for camera in longer:
            camera['parameters']['f_px'] *= 2
        for second, says in ((view(room(0), cameras=longer, turn_rad=0.3), 'recorded with another rig'),
                             (view(room(0), turn_rad=0.3), 'q.jsonl: view 1, look 2 has no cameras'),
                             (view(room(0), cameras=rig['cameras'][:1], turn_rad=0.3),
                              'q.jsonl: view 1, look 2: is of one camera'),
                             (view(room(0), cameras=rig['cameras']), 'has no "turn_rad"')):
            write(self.folder / 'q.jsonl', [{'looks': [first, second]}])
            self.refused(*ask, says=says)
        write(self.folder / 'two.jsonl', [view(room(0), cameras=rig['cameras'], pose=[0, 0, 0]),
                                          view(room(1), cameras=longer, pose=[9, 0, 0])])
        self.refused('map', 'make', '--features', 'two.jsonl', '-o', 'two.map',
                     says='two.jsonl: view 2: those before were taken with another rig')
        self.assertFalse((self.folder / 'two.map').exists())

    def test_methods_of_one_look_say_so(self):
        self.map_of_rooms()
        write(self.folder / 'q.jsonl',
              [{'looks': [view(room(2)), view(room(2), 0, 0, 0.3, turn_rad=0.3)]}])
        run = self.run_program('localise', 'rooms.map', '--features', 'q.jsonl', '--rig', 'nominal',
                               '--method', 'pgh', '--json')
        self.assertIn('--method pgh uses the first look alone, and 1 view has more', run.stderr)
        self.assertEqual(json.loads(run.stdout)['queries'][0]['looks'], 1)

    def test_the_next_look_is_said(self):
        self.done('map', 'make', '--world', 'workshop', '--spacing-m', '2', '--headings', '4',
                  '-o', 'w.map')
        write(self.folder / 'q.jsonl', [{'lines': []}])
        run = self.run_program('localise', 'w.map', '--features', 'q.jsonl', '--rig', 'nominal')
        self.assertEqual(run.returncode, 3)
        self.assertRegex(run.stdout, r'a further look, turned from the first .*, would tell more: view 1: [+-]\d+ deg')

    def test_without_evidence_it_abstains(self):
        self.map_of_rooms()
        parallel = [{'a_m': [3 + i, 1, 0], 'b_m': [3 + i, -1, 0], 'kind': 'level', 'sigma_m': 0.02}
                    for i in range(5)]
        one = room(0)[:1]
        for lines in ([], view(one)['lines'] or parallel[:1], parallel):
            write(self.folder / 'q.jsonl', [{'lines': lines}])
            run = self.run_program('localise', 'rooms.map', '--features', 'q.jsonl', '--rig', 'nominal')
            self.assertEqual(run.returncode, 3, run.stdout + run.stderr)
            self.assertEqual(run.stderr.count('\n'), 1, run.stderr)

    def test_images(self):
        call = ['--left', 'big_left.pgm', '--right', 'big_right.pgm', '--rig', 'rig.json']
        rig = json.loads((self.folder / 'rig.json').read_text())
        width, height = map(int, (self.folder / 'big_left.pgm').read_text(errors='ignore').split()[1:3])
        for camera in rig['cameras']:
            camera['size_px'] = [width, height]
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        (self.folder / 'poses.csv').write_text('image,x_m,y_m,heading_deg\nbig_left.pgm,3,-2,90\n')
        made = json.loads(self.done('map', 'make', *call, '--poses', 'poses.csv', '-o', 'i.map', '--json'))
        self.assertGreater(made['lines_median'], 20)
        query = json.loads(self.done('localise', 'i.map', *call, '--json'))['queries'][0]
        self.assertEqual(query['status'], 'answered')
        for found, true, within in zip(query['pose'], (3, -2, 90), (0.02, 0.02, 0.5)):
            self.assertAlmostEqual(found, true, delta=within)
        self.refused('map', 'make', *call, '-o', 'j.map', says='give --poses')
        self.refused('localise', 'i.map', *call, '--method', 'corners', says='map make --corners')
        # Its corners all look alike: there is nothing to go by.
        self.done('map', 'make', *call, '--poses', 'poses.csv', '--corners', '-o', 'c.map')
        self.done('localise', 'c.map', *call, '--method', 'corners', code=3)
        chance = random.Random(3)
        tiles = [[chance.randrange(256) for _ in range(80)] for _ in range(60)]
        for name, shift in (('left', 0), ('right', 6)):
            pixels = bytes(tiles[v // 7][(u + shift) // 7] for v in range(height) for u in range(width))
            (self.folder / f'big_{name}.pgm').write_bytes(b'P5\n%d %d\n255\n' % (width, height) + pixels)
        made = json.loads(self.done('map', 'make', *call, '--poses', 'poses.csv', '--corners', '-o',
                                    'c.map', '--json'))
        self.assertGreater(made['corners_mean'], 100)
        query = json.loads(self.done('localise', 'c.map', *call, '--method', 'corners',
                                     '--json'))['queries'][0]
        self.assertEqual(query['status'], 'answered')
        for found, true in zip(query['pose'], (3, -2, 90)):
            self.assertAlmostEqual(found, true, delta=1e-6)

    def test_images_of_one_name_in_several_folders(self):
        left, right = ((self.folder / f'big_{side}.pgm').read_bytes() for side in ('left', 'right'))
        rig = json.loads((self.folder / 'rig.json').read_text())
        size = list(map(int, left.split(maxsplit=3)[1:3]))
        for camera in rig['cameras']:
            camera['size_px'] = size
        (self.folder / 'rig.json').write_text(json.dumps(rig))
        for number in ('000', '001'):
            folder = self.folder / 'set' / number
            folder.mkdir(parents=True)
            (folder / 'left.pgm').write_bytes(left)
            (folder / 'right.pgm').write_bytes(right)
        call = ['map', 'make', '--left', 'set/*/left.pgm', '--right', 'set/*/right.pgm', '--rig', 'rig.json',
                '--poses', 'poses.csv', '-o', 'set.map']
        header = 'image,x_m,y_m,heading_deg\n'
        poses = self.folder / 'poses.csv'
        poses.write_text(header + '001/left.pgm,5,1,0\n000/left.pgm,3,-2,90\n')
        self.assertIn('2 nodes at 2 positions', self.done(*call))
        poses.write_text(header + 'left.pgm,3,-2,90\n')
        self.refused(*call, says='"left.pgm" stands for both')
        poses.write_text(header + '000/left.pgm,3,-2,90\n002/left.pgm,3,-2,90\n')
        self.refused(*call, says='has no pose of')

    def test_a_program_of_ones_own(self):
        self.map_of_rooms()
        write(self.folder / 'q.jsonl', [view(room(4))])
        mine = f"python3 '{ROOT / 'docs/examples/own_localiser.py'}'"
        words = ['localise', 'rooms.map', '--features', 'q.jsonl', '--rig', 'nominal', '--method',
                 'program', '--json']
        found = json.loads(self.done(*words, '--command', mine))
        self.assertEqual(found['queries'][0]['node'], 4)
        run = self.run_program(*words, '--command', 'false')
        self.assertEqual(run.returncode, 3)
        self.assertIn('has ended', run.stderr)
        self.refused(*words, says='--command')
        self.refused(*words, '--command', './no-such-program', says='no-such-program')

    def test_bad_input(self):
        self.map_of_rooms()
        ask = ['localise', 'rooms.map', '--features', 'q.jsonl', '--rig', 'nominal', '-o', 'a.csv']
        line = {'a_m': [3, 0, 0], 'b_m': [3, 0, 1.5], 'kind': 'vertical', 'sigma_m': 0.02}
        for wrong, says in (({**line, 'b_m': [3, 0, 0]}, 'same point'),
                            ({**line, 'a_m': [3000, 0, 0]}, 'give metres'),
                            ({**line, 'sigma_m': float('nan')}, 'q.jsonl:1')):
            write(self.folder / 'q.jsonl', [{'lines': [wrong]}])
            self.refused(*ask, says=says)
        write(self.folder / 'q.jsonl', [{'lines': [line]}])
        self.refused(*ask[:4], says='has no cameras')
        self.refused('localise', 'q.jsonl', *ask[2:], says='q.jsonl: ')
        self.refused('localise', 'none.map', *ask[2:], says='none.map: ')
        self.refused(*ask, '--method', 'sift', says='unknown method')
        self.refused(*ask, '--candidates', '0', says='candidates')
        for option, value, method in (('--command', 'true', 'lines'), ('--ranker', 'pgh', 'pgh'),
                                      ('--stages', 'none', 'pgh_baseline'), ('--min-corners', '9', 'lines'),
                                      ('--max-error-rate', '0.1', 'corners')):
            self.refused(*ask, option, value, '--method', method, says=f'no effect on --method {method}')
        self.refused(*ask, '--world', 'workshop', says='more than one kind')
        self.refused('localise', 'rooms.map', says='no views are given')
        self.refused('localise', 'rooms.map', '--left', 'left.pgm', '--rig', 'rig.json', says='one camera')
        self.refused('localise', 'rooms.map', '--world', 'workshop', '--rig', 'rig.json', '--source',
                     'none', says='another rig')
        rig = json.loads((ROOT / 'datasets/rigs/nominal.rig.json').read_text())
        for camera in rig['cameras']:
            camera['parameters']['k1'] = 0.4
        cameras = {key: rig[key] for key in ('format', 'version', 'cameras')}
        (self.folder / 'wide.json').write_text(json.dumps(cameras))
        self.refused(*ask[:4], '--rig', 'wide.json', says='another lens')
        self.refused('localise', 'rooms.map', '--features', 'q.jsonl', '--rig', 'nominal', '-o',
                     'rooms.map', says='rooms.map')
        self.refused('map', 'make', '--features', 'rooms.jsonl', says='no map is named')
        self.refused('map', 'make', '--features', 'q.jsonl', '-o', 'x.map', says='has no pose')
        self.refused('map', 'make', '--world', 'workshop', '--features', 'q.jsonl', '-o', 'x.map',
                     says='more than one kind')

    def test_damaged_maps(self):
        self.map_of_rooms()
        write(self.folder / 'q.jsonl', [view(room(1))])
        whole = (self.folder / 'rooms.map').read_bytes()
        ask = ['localise', 'bad.map', '--features', 'q.jsonl', '--rig', 'nominal']
        for bytes_of in (b'', whole[:100], whole[:-1], b'X' + whole[1:], whole[:8] + b'\x63' + whole[9:],
                         whole[:200] + bytes([whole[200] ^ 1]) + whole[201:]):
            (self.folder / 'bad.map').write_bytes(bytes_of)
            self.refused(*ask, says='bad.map: ')
            self.refused('map', 'info', 'bad.map', says='bad.map: ')
            self.refused('map', 'make', '--features', 'rooms.jsonl', '--rig', 'nominal', '--extend',
                         'bad.map', says='bad.map: ')


if __name__ == '__main__':
    sys.argv.pop(1)
    unittest.main()
