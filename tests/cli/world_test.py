# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""vernier world as a user calls it: import, route, info, export, view.

    world_test.py PROGRAM [unittest's options]
"""
import json
import pathlib
import re
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import verb_calls

PROGRAM = pathlib.Path(sys.argv[1]).resolve()


class World(verb_calls.ProgramCase):
    program = PROGRAM
    first_words = ('world',)

    def done(self, *words):
        run = self.run_program(*words, '--json')
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads(run.stdout)

    def refused(self, *words):
        run = self.run_program(*words)
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
        self.assertTrue(run.stderr.startswith('vernier: '))
        return run.stderr

    def test_a_room_becomes_a_world_that_a_study_reads(self):
        made = self.done('import', 'room.ply', '-o', 'room.world.toml', '--plan', 'room.svg')
        self.assertEqual((made['up'], made['unit_m']), ('z', 1))
        self.assertEqual(made['up_because'], 'by its shape')
        self.assertEqual(made['triangles'], 18)
        # 12 edges of the room and of the column 12, its foot and top open; no floor is cut out.
        self.assertEqual(made['segments'], 24)
        self.assertGreater(made['route_m'], 3)
        self.assertGreater(made['floor_near_route_m2'], 0.9 * made['floor_m2'])
        self.assertIn('<svg', (self.folder / 'room.svg').read_text())
        info = self.done('info', 'room.world.toml', '--poses', 20)
        self.assertEqual(info['segments'], made['segments'])
        self.assertLessEqual(info['aliasing']['unique_share'], info['aliasing']['ceiling'])
        (self.folder / 'study.toml').write_text(
            '[study]\ntrials = 3\n[world]\nfile = "room.world.toml"\n')
        study = subprocess.run([PROGRAM, 'study', 'study.toml', '-o', 'out', '--threads', '1', '--json'],
                               capture_output=True, text=True, cwd=self.folder, timeout=120)
        self.assertIn(study.returncode, (0, 3), study.stderr)
        cell = json.loads(study.stdout)['cells'][0]
        same = self.done('info', 'room.world.toml', '--poses', 3, '--protocol', 'path', '--seed', 1)
        self.assertAlmostEqual(cell['world_ceiling'], same['aliasing']['ceiling'], 12)
        self.assertAlmostEqual(cell['unaliased_share'], same['aliasing']['unique_share'], 12)

    def test_edges_outside_the_storey_are_said_to_be_below_or_above(self):
        for words, said in ((('--floor-m', '0.5'), '8 below the floor, 0 above the top and 0 shorter'),
                            (('--floor-m', '0', '--top-m', '1'),
                             '0 below the floor, 8 above the top and 0 shorter')):
            run = self.run_program('import', 'room.ply', '--no-route', '-o', 'cut.world.toml', *words)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn('24 edges, of them ' + said, run.stdout)

    def test_buildings_of_every_kind_and_of_several(self):
        for kinds in ('office', 'home', 'hall', 'corridors', 'home,hall'):
            made = self.done('make', '--kind', kinds, '--seed', 5, '-o', 'made.world.toml')
            again = (self.folder / 'made.world.toml').read_bytes()
            self.done('make', '--kind', kinds, '--seed', 5, '-o', 'made.world.toml')
            self.assertEqual((self.folder / 'made.world.toml').read_bytes(), again)
            self.assertGreater(made['route_m'], 10)
            info = self.done('info', 'made.world.toml', '--poses', 20)
            self.assertGreater(info['aliasing']['ceiling'], 0.5)
        self.assertIn("office, home, hall or corridors",
                      self.refused('make', '--kind', 'castle', '-o', 'no.world.toml'))
        self.assertIn('4.5 m', self.refused('make', '--kind', 'hall', '--size-m', '30,20,3',
                                            '-o', 'no.world.toml'))
        self.assertFalse((self.folder / 'no.world.toml').exists())

    def test_view_sets_are_made_used_and_compared(self):
        self.done('make', '--kind', 'home', '--size-m', '7,6,2.5', '--seed', 2, '-o', 'h.world.toml')
        made = self.done('sets', 'h.world.toml', '--spacing-m', 1, '--headings', 8, '--poses', 20,
                         '-o', 's.world.toml')
        self.assertGreater(made['sets'], 10)
        self.assertLess(made['agreement']['precision'], 1)
        info = self.done('info', 's.world.toml', '--poses', 20)
        self.assertEqual(info['view_sets']['recall'], made['agreement']['recall'])
        study = '[study]\ntrials = 3\n[world]\nfile = "{}"\nvisibility = "view_sets"\n'
        for world, code in (('s.world.toml', (0, 3)), ('h.world.toml', (2,))):
            (self.folder / 'study.toml').write_text(study.format(world))
            run = subprocess.run([PROGRAM, 'study', 'study.toml', '-o', f'of-{world}', '--threads',
                                  '1'], capture_output=True, text=True, cwd=self.folder, timeout=120)
            self.assertIn(run.returncode, code, run.stderr)
        self.assertIn('has no view sets', run.stderr)

    def test_what_is_read_is_not_overwritten(self):
        lines = '0 0 0 4 0 0\n4 0 0 4 3 0\n4 3 0 0 3 0\n0 3 0 0 0 0\n0 0 0 0 0 2.5\n'
        (self.folder / 'l.txt').write_text(lines)
        for words, said in ((('-o', 'l.txt'), 'would be overwritten'),
                            (('-o', 'w.toml', '--plan', 'l.txt'), 'does not end in .svg')):
            self.assertIn(said, self.refused('import', 'l.txt', *words))
        self.assertEqual((self.folder / 'l.txt').read_text(), lines)
        self.assertFalse((self.folder / 'w.toml').exists())
        self.assertIn('--height-m', self.refused('sets', 'workshop', '-o', 'w.toml', '--height-m', 99))
        self.assertFalse((self.folder / 'w.toml').exists())

    def test_units_and_axes_are_given_or_asked_for(self):
        text = (self.folder / 'room.ply').read_text()
        head, body = text.split('end_header\n')
        points = body.split('\n')[:36]
        inches = [' '.join(str(float(x) / 0.0254) for x in point.split()) for point in points]
        (self.folder / 'inch.ply').write_text(
            head + 'end_header\n' + '\n'.join(inches + body.split('\n')[36:]))
        made = self.done('import', 'inch.ply', '-o', 'inch.world.toml', '--unit', 'in')
        self.assertAlmostEqual(made['size_m'][0], 6, places=3)
        self.assertEqual(made['unit_because'], 'given')
        self.assertIn('is no unit of length', self.refused('import', 'room.ply', '-o', 'x', '--unit', 'ell'))
        self.assertIn('is no axis', self.refused('import', 'room.ply', '-o', 'x', '--up', 'w'))
        tiny = [' '.join(str(float(x) * 1e-7) for x in point.split()) for point in points]
        (self.folder / 'tiny.ply').write_text(
            head + 'end_header\n' + '\n'.join(tiny + body.split('\n')[36:]))
        self.assertIn('no building in m, cm, mm, in or ft', self.refused('import', 'tiny.ply', '-o', 'x'))
        self.assertFalse((self.folder / 'x').exists())

    def test_a_list_with_y_up_is_doubted(self):
        room = ('0 0 0 6 0 0\n6 0 0 6 0 4\n6 0 4 0 0 4\n0 0 4 0 0 0\n0 2.5 0 6 2.5 0\n6 2.5 0 6 2.5 4\n'
                '6 2.5 4 0 2.5 4\n0 2.5 4 0 2.5 0\n0 0 0 0 2.5 0\n6 0 0 6 2.5 0\n6 0 4 6 2.5 4\n0 0 4 0 2.5 4\n')
        (self.folder / 'y.txt').write_text(room)
        run = self.run_program('import', 'y.txt', '-o', 'y.world.toml')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('by its shape y is; see --up', run.stderr)
        self.assertIn('z is up (as in all lists)', run.stdout)
        told = self.run_program('import', 'y.txt', '-o', 'y.world.toml', '--up', 'y')
        self.assertNotIn('by its shape', told.stderr)

    def test_tracks_without_a_unit_are_said_to_have_none(self):
        room = [('0 0 0', '8 0 0'), ('8 0 0', '8 6 0'), ('8 6 0', '0 6 0'), ('0 6 0', '0 0 0'),
                ('0 0 2.6', '8 0 2.6'), ('8 0 2.6', '8 6 2.6'), ('8 6 2.6', '0 6 2.6'),
                ('0 6 2.6', '0 0 2.6'), ('0 0 0', '0 0 2.6'), ('8 0 0', '8 0 2.6'),
                ('8 6 0', '8 6 2.6'), ('0 6 0', '0 6 2.6')]
        tracks = ''.join(f'{i} 2 2\n{a}\n{b}\n1 2\n0 0\n' for i, (a, b) in enumerate(room))
        (self.folder / 'tracks.txt').write_text(f'{len(room)}\n{tracks}')
        run = self.run_program('import', 'tracks.txt', '-o', 't.world.toml')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('images give no unit of length; 1 m was taken', run.stderr)
        self.assertNotIn('(given)', run.stdout)
        told = self.run_program('import', 'tracks.txt', '-o', 't.world.toml', '--unit', '1.5')
        self.assertNotIn('no unit of length', told.stderr)

    def test_views_are_those_of_the_camera_at_its_height(self):
        seen = {height: self.done('info', 'workshop', '--poses', 10, '--height-m', height)['aliasing']
                for height in (0.6, 1.2)}
        self.assertEqual([seen[height].pop('height_m') for height in (0.6, 1.2)], [0.6, 1.2])
        self.assertEqual(seen[1.2]['poses'], 10)
        # a camera under the ceiling, where nothing is free, and a route of which a part is blocked
        self.assertIn('lower the camera', self.refused('info', 'workshop', '--poses', 10, '--height-m', 2.9))
        self.done('import', 'room.ply', '-o', 'part.world.toml')
        text = (self.folder / 'part.world.toml').read_text()
        (self.folder / 'part.world.toml').write_text(
            text[:text.index('[[route]]')] + '[[route]]\npoints_m = [[1.5, 1.5], [-4, 1.5]]\n')
        run = self.run_program('info', 'part.world.toml', '--poses', 10)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('leads through something in', run.stderr)

    def test_what_is_no_world_is_to_be_imported(self):
        self.assertIn('import it first', self.refused('info', 'room.ply'))

    def test_lines_alone_are_said_to_hide_nothing(self):
        (self.folder / 'a.lines.txt').write_text(
            '0 0 0 6 0 0\n6 0 0 6 4 0\n6 4 0 0 4 0\n0 4 0 0 0 0\n0 0 0 0 0 2.5\n6 4 0 6 4 2.5\n')
        run = self.run_program('import', 'a.lines.txt', '-o', 'a.world.toml')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('nothing hides anything', run.stderr)
        self.assertIn('route of', run.stdout)

    def test_bad_files_cost_one_line(self):
        for name, text, said in (
                ('a.ply', 'ply\n', 'end_header'),
                ('a.txt', '1 2 3\n', 'a.txt:1: has 3 numbers'),
                ('b.txt', '0 0 0 1 0 nan\n', 'is not finite'),
                ('c.txt', '', 'holds no triangles and no lines'),
                ('a.docx', 'x', 'a.docx: '),
                ('a.ifc', 'ISO-10303-21;\n', 'a.ifc: is cut short'),
                ('a.obj', 'v 0 0 0\nf 1 2 3\n', 'a.obj: ')):
            with self.subTest(name):
                (self.folder / name).write_text(text)
                self.assertIn(said, self.refused('import', name, '-o', 'out.world.toml'))
                self.assertFalse((self.folder / 'out.world.toml').exists())
        self.assertIn('no storey 4', self.refused('import', 'room.ply', '-o', 'x', '--storey', 4))
        self.assertIn('leave one out', self.refused('import', 'room.ply', '-o', 'x', '--storey', 2,
                                                    '--floor-m', 0))
        self.assertIn('no names of parts', self.refused('import', 'room.ply', '-o', 'x',
                                                        '--leave-out', 'door'))
        self.assertIn('neither an OBJ nor a PLY', self.refused('export', 'workshop', '-o', 'x.dae'))

    def test_a_route_is_proposed_for_any_world(self):
        made = self.done('route', 'workshop', '-o', 'my.world.toml', '--plan', 'my.svg')
        self.assertGreater(made['route_m'], 50)
        self.assertEqual(made['segments'], 9541)
        # Its own is as good: the world without its route is told what to do.
        text = (self.folder / 'my.world.toml').read_text()
        (self.folder / 'bare.world.toml').write_text(text[:text.index('[[route]]')])
        run = self.run_program('info', 'bare.world.toml')
        self.assertIn('vernier world route', run.stderr)

    def test_a_route_through_walls_and_corners_that_are_missing_are_told(self):
        self.done('import', 'room.ply', '-o', 'room.world.toml')
        text = (self.folder / 'room.world.toml').read_text()
        through_the_wall = '[[route]]\npoints_m = [[1.5, 1.5], [-20, 1.5]]\n'
        (self.folder / 'wall.world.toml').write_text(text[:text.index('[[route]]')] + through_the_wall)
        run = self.run_program('info', 'wall.world.toml', '--poses', 0)
        self.assertIn('wall.world.toml: its route leads through something in', run.stderr)
        (self.folder / 'bare.world.toml').write_text(
            'format = "vernier/world"\nversion = 1\nname = "bare"\n[loose]\nsegments = [\n' +
            ''.join(f'[{x}, 4, 0, {x}, 4, 2.5],\n' for x in range(1, 6)) +
            ']\n[[route]]\npoints_m = [[1, 1], [5, 1]]\n')
        (self.folder / 'study.toml').write_text('[study]\ntrials = 3\n[world]\nfile = "bare.world.toml"\n'
                                                '[localiser]\nmethod = "corners"\n')
        study = subprocess.run([PROGRAM, 'study', 'study.toml', '-o', 'out'], capture_output=True,
                               text=True, cwd=self.folder, timeout=120)
        self.assertEqual(study.returncode, 2, study.stderr)
        self.assertIn('study.toml:6: localiser "corners" looks for corners', study.stderr)
        self.assertFalse((self.folder / 'out').exists())

    def test_the_page_holds_all_it_needs(self):
        run = self.run_program('view', 'workshop', '--poses', 4, '-o', 'view.html')
        if 'libjs-three' in run.stderr:
            self.skipTest('built without three.js')
        self.assertEqual(run.returncode, 0, run.stderr)
        page = (self.folder / 'view.html').read_text()
        self.assertNotIn('VERNIER:', page)
        self.assertFalse(re.findall(r'(?:src|href)="(?!data:)', page.split('<script')[0]))
        data = json.loads(page.split('id="data">')[1].split('</script>')[0])
        self.assertEqual(len(data['views']), 4)
        self.assertEqual(len(data['edges']) + len(data['edges_above']), 6 * 9541)
        names = {kind['name'] for kind in data['kinds']}
        self.assertIn('lost:edge_loss', names)
        for view in data['views']:
            self.assertLessEqual(set(view['edges']), names)
        pages = set()
        for source in ('calibration=0', 'moved=0.5', 'mount_pitch_deg=10'):
            self.done('view', 'workshop', '--poses', 2, '--source', 'none', '--source', source,
                      '-o', 'source.html')
            pages.add((self.folder / 'source.html').read_bytes())
        self.assertEqual(len(pages), 3)
        bare = self.done('view', 'workshop', '--poses', 2, '--source', 'none', '-o', 'bare.html')
        self.assertEqual(bare['poses'], 2)
        page = (self.folder / 'bare.html').read_text()
        data = json.loads(page.split('id="data">')[1].split('</script>')[0])
        self.assertEqual([kind['name'] for kind in data['kinds']], ['told'])


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
