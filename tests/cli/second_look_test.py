#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""What the program says against its own results, and to those who give it the wrong thing.

    second_look_test.py PROGRAM [unittest's options]
"""
import json
import math
import re
import shutil
import sys
import unittest

import cli_test
from cli_test import IMAGES, ROOT, board_lines, vernier


class Corners(cli_test.Case):
    """Simulated corners of a 9x6 board."""

    def corners(self, frames=12):
        (self.folder / 'o.csv').write_text('\n'.join(board_lines(frames=frames)))
        return ('--observations', self.folder / 'o.csv', '--size', '640x480')

    def calibrate(self, *more, frames=12, code=0):
        corners = self.corners(frames)
        words = corners[:2] if '--size' in more else corners
        done = vernier('calibrate', *words, '-o', self.folder / 'rig.json', *more)
        self.assertEqual(done.returncode, code, done.stderr)
        return done


class Result(Corners):
    def test_a_bent_board_is_shown(self):
        found = json.loads(self.calibrate('--warp', '--no-model-check', '--json').stdout)
        x, y = found['board_warp_m']
        self.assertLess(max(abs(x), abs(y)), 1e-3)  # the board is flat
        text = self.calibrate('--warp', '--no-model-check').stdout
        self.assertIn(f'board warp: {1e3 * x:.3f} / {1e3 * y:.3f} mm', text)
        self.assertNotIn('board warp', self.calibrate('--no-model-check').stdout)

    def test_the_aspect_of_a_board(self):
        found = json.loads(self.calibrate('--no-model-check', '--json').stdout)
        aspect = found['effects_test']['aspect']
        self.assertFalse(aspect['told'])  # the board is never turned
        self.assertGreater(aspect['sigma'], 5e-4)
        self.assertGreater(aspect['p_value'], 0.005)
        self.assertNotIn('board_aspect', found)
        self.assertIn('turn it by 90 degrees in some views',
                      self.calibrate('--no-model-check').stdout)
        self.assertNotIn('90 degrees', self.calibrate('--no-model-check', '--no-effects').stdout)
        found = json.loads(self.calibrate('--no-model-check', '--board-aspect', '--json').stdout)
        told = found['board_aspect']
        self.assertLess(abs(told['value']), 4 * told['sigma'])
        kept = json.loads((self.folder / 'rig.json').read_text())['calibration']['board_aspect']
        self.assertEqual(kept, told)
        done = vernier('check', self.folder / 'rig.json', '--trials', '60', '--json')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('all but the halves take it as known', done.stderr)
        self.assertTrue(all(gate['ok'] for gate in json.loads(done.stdout)['file'].values()
                            if isinstance(gate, dict) and 'ok' in gate))
        text = self.calibrate('--no-model-check', '--board-aspect').stdout
        self.assertIn(f"board aspect: {100 * told['value']:+.3f} % ± {100 * told['sigma']:.3f} %",
                      text)

    def test_a_bend_in_few_views(self):
        found = json.loads(self.calibrate('--no-model-check', '--json', frames=6).stdout)
        self.assertGreater(found['effects_test']['bend']['p_value'], 0.005)
        self.assertEqual(found['effects_test']['not_tested'], '6 views; it takes 8')
        flat = (self.folder / 'o.csv').read_text().splitlines()
        bent = flat[:1]
        for line in flat[1:]:
            f, c, row, col, X, Y, Z, u, v = (float(x) for x in line.split(','))
            height = 4e-3 * (1 - ((col - 4) / 4) ** 2)
            a, b = 0.5 * math.sin(2.1 * f), 0.5 * math.cos(1.7 * f)
            z = 0.6 + 0.02 * f
            u += 500 * height * math.sin(b) * math.cos(a) / z  # to first order, in the middle
            v -= 500 * height * math.sin(a) / z
            bent.append(f'{f:.0f},{c:.0f},{row:.0f},{col:.0f},{X},{Y},{Z},{u},{v}')
        (self.folder / 'b.csv').write_text('\n'.join(bent))
        done = vernier('calibrate', '--observations', self.folder / 'b.csv', '--size', '640x480',
                       '--no-model-check', '-o', self.folder / 'rig.json')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('the board is bent (p < 0.0001)', done.stdout)

    def test_cameras_may_differ_in_size(self):
        self.calibrate('--no-model-check', '--size', '640x480,660x500')
        rig = json.loads((self.folder / 'rig.json').read_text())
        self.assertEqual([camera['size_px'] for camera in rig['cameras']], [[640, 480], [660, 500]])
        done = self.calibrate('--size', '640x480,', code=2)
        self.assertIn('use the form 640x480', done.stderr)

    def test_a_held_parameter_is_called_so(self):
        hold = ('--hold', 'left.ax=1', '--no-model-check')
        text = self.calibrate(*hold).stdout
        self.assertRegex(text, r'(?m)^left\.ax +1 +fixed +fixed$')
        self.assertNotRegex(text, 'condition inf|scaled inf')
        found = json.loads(self.calibrate(*hold, '--json').stdout)
        self.assertGreater(found['scaled_condition'], 1)
        self.assertLess(found['scaled_condition'], 1e11)

    def test_data_against_a_prior(self):
        done = self.calibrate('--know', 'right.tx_m=-0.0700,0.0001', code=3)
        found = re.search(r'data and prior disagree: right.tx_m moved by ([\d.]+) of its prior',
                          done.stderr)
        self.assertGreater(float(found[1]), 10, done.stderr)
        self.assertIn('data and prior disagree',
                      json.loads((self.folder / 'rig.json').read_text())['calibration']['doubts'][0])
        self.calibrate('--know', 'right.tx_m=-0.0600,0.0010')

    def test_what_is_held_is_not_known_too(self):
        done = self.calibrate('--hold', 'right.tx_m=-0.083', '--know', 'right.tx_m=-0.083,0.001',
                              code=2)
        self.assertIn('right.tx_m: is also given a value with a standard deviation', done.stderr)

    def test_few_views_and_models_that_are_not_compared(self):
        said = self.calibrate(frames=5).stderr
        self.assertIn('only 5 views: the standard deviations themselves are uncertain', said)
        self.assertIn('models were not compared: 5 frames are too few, at least 6 are needed', said)
        self.assertNotIn('views: the standard', self.calibrate('--no-model-check').stderr)
        said = self.calibrate('--model', 'fisheye4').stderr
        self.assertIn('models were not compared: no richer model than fisheye4', said)

    def test_doubts_of_a_file_are_said_by_every_verb(self):
        self.calibrate('--no-model-check')
        rig = self.folder / 'rig.json'
        told = json.loads(rig.read_text())
        told['calibration']['doubts'] = ['the board was soft']
        rig.write_text(json.dumps(told))
        line = f'warning: {rig}: stored warning: the board was soft'
        for words in (('uncertainty', rig, '--samples', '50', '--grid', '4x3'),
                      ('sample', rig, '-n', '2', '-o', self.folder / 's.csv'),
                      ('advise', rig), ('diff', rig, 'nominal'),
                      ('report', rig, '-o', self.folder / 'r.html'),
                      ('convert', rig, '--to', 'opencv', '-o', self.folder / 'rig.yml')):
            done = vernier(*words)
            self.assertIn(done.returncode, (0, 3), done.stderr)
            said = done.stderr + done.stdout
            self.assertEqual(said.count('the board was soft'), 1, f'{words[0]}: {said}')
            self.assertIn(line if words[0] != 'convert' else line[9:], said, words[0])
        done = vernier('check', rig, '--no-mrcal', '--trials', '60', '--json')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('stored warning: the board was soft', json.loads(done.stdout)['doubts'][0])


@unittest.skipUnless((IMAGES / 'left01.jpg').exists(), 'opencv-doc has no images here')
class RealCorners(cli_test.Case):
    @classmethod
    def setUpClass(cls):
        cls.kept = cli_test.tempfile.TemporaryDirectory()
        cls.corners = cli_test.pathlib.Path(cls.kept.name) / 'corners.vnl'
        vernier('detect', '--left', IMAGES / 'left[0-9]*.jpg', '--right',
                IMAGES / 'right[0-9]*.jpg', '--board', '9x6', '-o', cls.corners,
                '--square-m', '0.025', '-q')

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    def calibrate(self, *more, square='0.025', code=0):
        done = vernier('calibrate', '--corners', self.corners, '--size', '640x480', '--board',
                       '9x6', '--square-m', square, '-o', self.folder / 'rig.json', *more)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def test_a_model_too_rich_for_the_views_is_doubtful(self):
        done = self.calibrate('--model', 'opencv8', code=3)
        self.assertRegex(done.stderr, 'not trustworthy: the views hardly determine this model: the '
                                      'scaled condition number of its parameters is [1-9].*; '
                                      'use --model opencv5')
        self.calibrate('--model', 'opencv5')

    def test_check_repeats_the_doubts_of_the_calibration(self):
        done = vernier('check', '--corners', self.corners, '--size', '640x480', '--board', '9x6',
                       '--square-m', '25', '--no-mrcal', '--trials', '60')
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn('did you mean 0.025?', done.stderr)

    def test_a_board_in_millimetres_is_doubtful(self):
        done = self.calibrate('--no-model-check', square='25', code=3)
        self.assertIn('the board measures 200 m, its points are 25 m apart: did you mean 0.025?',
                      done.stderr)

    def test_mrcal_agrees_on_a_bent_board(self):
        self.calibrate('--model', 'opencv4', '--warp', '--no-model-check')
        done = vernier('check', self.folder / 'rig.json', '--trials', '60', '--json')
        found = json.loads(done.stdout)
        if found['mrcal'] is None:
            self.skipTest(found['mrcal_reason'])
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn('restarted', found['mrcal'])
        if 'projection_reason' not in found['mrcal']:
            self.assertLess(found['mrcal']['max_projection_covariance_diff'], 1e-6)
            self.assertLess(found['mrcal']['max_triangulation_covariance_diff'], 1e-6)

    def stamped(self, name):
        """Three frames named by `name` of camera and frame."""
        for camera, side in enumerate(('left', 'right')):
            for frame in (1, 2, 3):
                to = self.folder / name.format(camera=camera, frame=frame)
                to.parent.mkdir(exist_ok=True)
                shutil.copy(IMAGES / f'{side}0{frame}.jpg', to)
        return ('--board', '9x6', '--square-m', '0.025')

    def test_time_stamps_number_frames_in_their_order(self):
        board = self.stamped('cam{camera}/140363657976355558{frame}.jpg')
        corners = self.folder / 'c.vnl'
        self.works('detect', '--left', self.folder / 'cam0/*.jpg', '--right',
                   self.folder / 'cam1/*.jpg', *board, '-o', corners)
        self.works('calibrate', '--corners', corners, '--size', '640x480', *board,
                   '--no-model-check', '-o', self.folder / 'rig.json')
        views = json.loads((self.folder / 'rig.json').read_text())['evidence']['observations']
        self.assertEqual([v['frame'] for v in views], [0, 0, 1, 1, 2, 2])

    def test_a_camera_after_the_frame_in_names(self):
        board = self.stamped('frame0{frame}_cam{camera}.jpg')
        self.complains('detect', '--left', self.folder / '*_cam0.jpg', '--right',
                       self.folder / '*_cam1.jpg', *board, '-o', self.folder / 'c.vnl',
                       of='another image of this camera has the frame number 0 too; the last '
                          'number in a name is the frame: name images like cam0_frame01.png')


class WrongThing(cli_test.Case):
    def test_files_of_another_kind(self):
        empty, yaml, mrcal = (self.folder / n for n in ('e.json', 'k.yaml', 'm.cameramodel'))
        empty.write_text('\n')
        yaml.write_text('%YAML:1.0\n---\ncam0: 1\n')
        mrcal.write_text("# generated\n{ 'lensmodel': 'LENSMODEL_OPENCV4' }\n")
        jpeg = self.folder / 'i.jpg'
        jpeg.write_bytes(b'\xff\xd8\xff\xe0\x00\x10JFIF')
        for verb in (('uncertainty',), ('check',), ('diff', 'nominal')):
            self.complains(*verb, empty, of='e.json: is empty')
            for file in (yaml, mrcal, jpeg):
                self.complains(*verb, file, of=f"{file.name}: is not a rig file; vernier convert "
                                               "reads files of Kalibr, OpenCV, ROS, mrcal")
            self.complains(*verb, self.folder, of='is a folder')

    def test_slips_on_the_command_line(self):
        board = ('--board', '9x6', '--square-m', '0.025', '-o', self.folder / 'r.json')
        self.complains('calibrate', '--left', 'a1.png', 'a2.png', 'a3.png', *board,
                       of='unexpected argument "a2.png" and 1 more; quote the pattern')
        self.complains('calibrate', 'rubbish', *board, of='unexpected argument "rubbish"')
        (self.folder / 'o.csv').write_text('\n'.join(board_lines(frames=4)))
        self.complains('calibrate', '--observations', self.folder / 'o.csv', '--size', '640',
                       '-o', self.folder / 'r.json', of='use the form 640x480')
        for words, meant in (
                (('studdy', 'a.toml'), "\"studdy\" and 1 more; did you mean 'study'? (see vernier --help)"),
                (('study', 'a.toml', '--thread=2'),
                 "\"--thread=2\"; did you mean '--threads'? (see vernier study --help)"),
                (('world', 'inof', 'office'), "\"inof\" and 1 more; did you mean 'info'?"),
                (('world', 'info', 'office', '--quite-different'),
                 '"--quite-different" (see vernier world info --help)'),
                (('calibrate', '--bord', '9x6'), "did you mean '--board'? (see vernier calibrate"),
                (('simulate', '--wor', 'office'), "did you mean '--world'?"),
                (('simulate', '--xy', '3'), '"--xy" and 1 more (see vernier simulate --help)')):
            self.complains(*words, of=meant)

    def test_the_table_says_where_its_corners_are(self):
        text = self.works('uncertainty', 'nominal', '--samples', '50', '--grid', '4x3').stdout
        self.assertIn("10 % of the image width and height inwards from the corner", text)


SURE = '''import json, sys
hello = json.loads(sys.stdin.readline())
nodes = [json.loads(sys.stdin.readline()) for _ in range(hello['nodes'])]
print('{"ready": true}', flush=True)
for line in sys.stdin:
    print(json.dumps({'question': json.loads(line)['question'], 'status': 'answered', 'node': 0,
                      'pose': nodes[0]['pose'], 'score': 1, %s}), flush=True)
'''
STUDY = '''[study]
trials = 40
protocol = "near_path"
[map]
spacing_m = 4
[localiser]
method = "program"
command = "python3 sure.py"
[sweep]
"study.seed" = [1, 2]
'''


class Study(cli_test.Case):
    def run_sure(self, stated):
        (self.folder / 'sure.py').write_text(SURE % stated)
        (self.folder / 's.toml').write_text(STUDY)
        shutil.rmtree(self.folder / 'out', ignore_errors=True)
        done = vernier('study', 's.toml', '-o', 'out', '--threads', '1', cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def test_more_wrong_answers_than_stated_are_said(self):
        done = self.run_sure("'probability': 0.9999")
        self.assertRegex(done.stderr, r'warning: \d+ of 40 answers of cell "study.seed = 1" are wrong, where the '
                                      r'localiser states 0\.01 %, and so in 1 more cells: what it states does not hold')
        again = vernier('study', 'status', 'out', cwd=self.folder)
        self.assertIn('are wrong, where the localiser states 0.01 %', again.stderr)

    def test_who_states_what_it_errs_is_not_blamed(self):
        self.assertNotIn('are wrong', self.run_sure("'probability': 0.01").stderr)

    def test_who_states_nothing_is_not_held_to_it(self):
        self.assertNotIn('are wrong', self.run_sure("'looks': 1").stderr)


if __name__ == '__main__':
    cli_test.PROGRAM = sys.argv.pop(1)
    unittest.main()
