# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Quick calls of every verb in its important modes, for tests that disturb the program (streams_test.py,
faults_test.py, permissions_test.py, memory_limits_test.py, full_disk_test.py,
signals_test.py, verb_texts_test.py and scripts/fault_trials.py), and a test case
that calls it in a folder with their inputs."""
import dataclasses
import functools
import json
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.dont_write_bytecode = True
import characterise_test
import evaluate_test
import stereo_test
from cli_test import IMAGES, ROOT, board_lines


@dataclasses.dataclass
class Call:
    name: str
    words: list       # of the command line, without the program
    outputs: list     # the files or folders it writes, in its folder
    code: int = 0     # its exit code
    changes: dict = dataclasses.field(default_factory=dict)  # outputs that are copies of these inputs before

    def prepare(self, folder):
        """Makes what it changes, before every call of it."""
        for name, source in self.changes.items():
            (folder / name).write_bytes((folder / source).read_bytes())

    @property
    def grows(self):
        """Whether its folder grows block by block, and is gone on with."""
        return self.words[0] in ('study', 'tune') and self.words[1] not in ('merge', 'status')


# One that other users may run too (permissions_test.py); that of these tests may be somebody's own.
PYTHON = '/usr/bin/python3' if os.access('/usr/bin/python3', os.X_OK) else sys.executable

WORLD = '''format = "vernier/world"
version = 1
name = "posts"

[[template]]
name = "post"
segments = [[0, 0, 0, 0, 0, 2], [0.3, 0, 0, 0.3, 0, 2], [0, 0, 2, 0.3, 0, 2]]
surfaces = [[[0, 0, 0], [0.3, 0, 0], [0.3, 0, 2], [0, 0, 2]]]
corners = [[0, 0, 2], [0.3, 0, 2]]

[[route]]
points_m = [[2, 2], [5, 2]]
''' + ''.join(f'''
[[instance]]
template = "post"
at_m = [{0.7 * (i % 10) + 0.2 * (i % 3):.1f}, {4 + 0.4 * (i % 4):.1f}, 0]
yaw_deg = {20 * (i % 5)}
''' for i in range(20))

STUDY = ('[study]\ntrials = 120\nprotocol = "near_path"\n[map]\nspacing_m = 2\n'
         '[world]\nfile = "posts.world.toml"\n[rig]\nfile = "nominal"\n[sweep]\n"sources.calibration" = [0, 1]\n')


PROGRAM_STUDY = f'''[study]
trials = 12
[system]
name = "program"
command = "{PYTHON} {ROOT}/docs/examples/own_system.py"
success_error = 0.05
[rig]
file = "nominal"
[parameters]
range_m = 4
'''

# Races the node spacing, and confirms in the same world seen from elsewhere.
TUNE = (STUDY.replace('"sources.calibration" = [0, 1]', '"map.spacing_m" = [1, 2]') +
        '[tune]\nconfirm_worlds = ["yard.world.toml"]\nconfirm_trials = 12\n')


def matched_pairs():
    """A pairs file of the rig of stereo_test."""
    chance = random.Random(3)
    lines = ['pair,u_left_px,v_left_px,u_right_px,v_right_px,sigma_px']
    for image in range(2):
        for _ in range(60):
            u, v, z = chance.uniform(40, 180), chance.uniform(10, 110), chance.uniform(1, 4)
            right = u - stereo_test.F_PX * stereo_test.BASELINE_M / z
            noise = [chance.gauss(0, 0.1) for _ in range(4)]
            lines.append(f'{image},{u + noise[0]},{v + noise[1]},{right + noise[2]},{v + noise[3]},0.1')
    return '\n'.join(lines) + '\n'


def features():
    """Views of upright lines at known poses."""
    chance = random.Random(5)
    lines = [{'a_m': [x, chance.uniform(-0.4, 0.4) * x, 0], 'b_m': [x, 0, 1.8], 'kind': 'vertical',
              'sigma_m': 0.02} for x in (2 + 0.2 * i for i in range(20))]
    for line in lines:
        line['b_m'][1] = line['a_m'][1]
    return ''.join(json.dumps({'pose': [i, 0, 0], 'lines': lines[i:]}) + '\n' for i in range(5))


def room():
    """A room of 6 x 4 x 2.5 m with a floor and a column, as PLY."""
    points, faces = [], []

    def face(*corners):
        faces.append(' '.join(map(str, (4, *range(len(points), len(points) + 4)))))
        points.extend(' '.join(map(str, corner)) for corner in corners)

    def walls(x0, y0, x1, y1):
        for (xa, ya), (xb, yb) in zip(((x0, y0), (x1, y0), (x1, y1), (x0, y1)),
                                      ((x1, y0), (x1, y1), (x0, y1), (x0, y0))):
            face((xa, ya, 0), (xb, yb, 0), (xb, yb, 2.5), (xa, ya, 2.5))
    walls(0, 0, 6, 4)
    walls(4, 2, 4.3, 2.3)
    face((0, 0, 0), (6, 0, 0), (6, 4, 0), (0, 4, 0))
    return '\n'.join(['ply', 'format ascii 1.0', f'element vertex {len(points)}', 'property float x',
                      'property float y', 'property float z', f'element face {len(faces)}',
                      'property list uchar int vertex_indices', 'end_header', *points, *faces, ''])


def map_file(views):
    """A map of views of upright lines, with the shipped rig (docs/file-formats.md)."""
    def part(kind, content):
        filled = content + bytes(-len(content) % 8)
        checksum = 0xcbf29ce484222325 ^ len(content)
        for (word,) in struct.iter_unpack('<Q', filled):
            checksum = (checksum ^ word) * 0x100000001b3 % 2**64
            checksum ^= checksum >> 32
        return struct.pack('<IIQQ', kind, 0, len(content), checksum) + filled
    rig = (ROOT / 'datasets/rigs/nominal.rig.json').read_bytes()
    nodes = struct.pack('<Q', len(views))
    for view in map(json.loads, views):
        nodes += struct.pack('<3dII', *view['pose'], len(view['lines']), 0)
        for line in view['lines']:
            nodes += struct.pack('<Q7d', 0, *line['a_m'], *line['b_m'], line['sigma_m'])
    return (b'VERNMAP\0' + struct.pack('<II', 1, len(views)) +
            part(1, struct.pack('<2d', 1.2, 0) + rig) + part(2, nodes))


def png16(rows):
    """A PNG file of one channel of 16 bits."""
    def chunk(kind, data):
        return (struct.pack('>I', len(data)) + kind + data +
                struct.pack('>I', zlib.crc32(kind + data)))
    raw = b''.join(b'\0' + struct.pack(f'>{len(row)}H', *row) for row in rows)
    head = struct.pack('>IIBBBBB', len(rows[0]), len(rows), 16, 0, 0, 0, 0)
    return (b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', head) + chunk(b'IDAT', zlib.compress(raw)) +
            chunk(b'IEND', b''))


def write_seen(folder):
    """Three views of a wall 3 m ahead with upright lines on it, of a camera that steps sideways."""
    covariance = [[1e-4 * (i == k) for k in range(6)] for i in range(6)]
    poses = ['image,' + ','.join(f't{i}{j}' for i in range(4) for j in range(4))]
    seen = []
    for i in range(3):
        segments = [{'image_px': [40 * n, 20, 40 * n, 90], 'a_m': [0.5 * n - 1 - 0.2 * i, -1, 3],
                     'b_m': [0.5 * n - 1 - 0.2 * i, 1, 3], 'covariance_m2': covariance}
                    for n in range(5)]
        seen.append(json.dumps({'image': f'seen{i}.png', 'segments': segments}))
        poses.append(f'seen{i}.png,0,0,1,0,-1,0,0,{-0.2 * i},0,-1,0,0.3,0,0,0,1')
        (folder / f'seen{i}.png').write_bytes(png16([[3000] * 160] * 120))
    (folder / 'seen.segments').write_text('\n'.join(seen) + '\n')
    (folder / 'seen.csv').write_text('\n'.join(poses) + '\n')
    (folder / 'inside.csv').write_text(poses[0] + '\n' + ''.join(
        f'{i},1,0,0,{3 + 0.1 * i},0,0,1,2,0,-1,0,0,0,0,0,1\n' for i in range(3)))
    one = {'name': 'depth', 'model': 'pinhole', 'size_px': [160, 120],
           'parameters': {'f_px': 150, 'ax': 1, 'ay': 1, 'ox_px': 79.5, 'oy_px': 59.5}}
    (folder / 'depth.rig.json').write_text(json.dumps(
        {'format': 'vernier/rig', 'version': 1, 'cameras': [one]}))
    (folder / 'K.txt').write_text('150 0 80\n0 150 60\n0 0 1\n')


# The folders among the inputs; all but the first are made by the program.
FOLDERS = ('begun', 'parts', 'whole', 'judged')


@functools.cache
def made_by(program):
    """A folder with what the calls read of earlier ones, made once."""
    keeper = tempfile.TemporaryDirectory()
    made_by.keepers.append(keeper)
    folder = pathlib.Path(keeper.name)
    write_inputs(folder)
    (folder / 'few.toml').write_text(STUDY.replace('trials = 120', 'trials = 12'))
    for words in (['study', 'few.toml', '-o', 'parts', '--shard', '0/2'],
                  ['study', 'few.toml', '-o', 'parts', '--shard', '1/2'],
                  ['study', 'merge', 'parts', '-o', 'whole'],
                  [*JUDGE, '--matcher', 'edge', '-o', 'judged'],
                  ['convert', 'rig.json', '--to', 'opencv', '-o', 'rig.yml'],
                  ['map', 'make', '--world', 'workshop', '--spacing-m', '2', '-o', 'workshop.map']):
        done = subprocess.run([program, *words, '-q'], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f'{" ".join(words)}: exit {done.returncode}: {done.stderr}')
    return folder


made_by.keepers = []


def write_inputs(folder, program=None):
    """What the calls read; what the program itself must make only if it is given."""
    folder = pathlib.Path(folder)
    if program:
        made = made_by(str(program))
        for name in FOLDERS[1:]:
            shutil.copytree(made / name, folder / name)
        for name in ('rig.yml', 'workshop.map'):
            shutil.copy(made / name, folder / name)
    for image in sorted(IMAGES.glob('*0[1-3].jpg')):
        if image.name.startswith(('left', 'right')):
            shutil.copyfile(image, folder / image.name)
    (folder / 'matcher.sh').write_text('cp six.pfm "$3"\n')
    (folder / 'six.pfm').write_bytes(b'Pf\n%d %d\n-1\n' % (evaluate_test.WIDTH, evaluate_test.HEIGHT) +
                                     struct.pack('<f', 6) * evaluate_test.WIDTH * evaluate_test.HEIGHT)
    (folder / 'own.toml').write_text(PROGRAM_STUDY)
    for name, rows in zip(('left', 'right', 'truth'), evaluate_test.pair()):
        evaluate_test.write_pgm(folder / f'{name}.pgm', rows)
    for name, rows in zip(('big_left', 'big_right', 'big_truth'), characterise_test.pair()):
        evaluate_test.write_pgm(folder / f'{name}.pgm', rows)
    (folder / 'depth.png').write_bytes(png16([[2000] * evaluate_test.WIDTH] * evaluate_test.HEIGHT))
    (folder / 'rig.json').write_text(json.dumps(stereo_test.pinholes()))
    (folder / 'commands.csv').write_text('speed_mps,turn_radps,duration_s\n0.3,0.1,0.5\n')
    (folder / 'corners.csv').write_text('\n'.join(board_lines()))
    (folder / 'pairs.csv').write_text(matched_pairs())
    (folder / 'posts.world.toml').write_text(WORLD)
    (folder / 'study.toml').write_text(STUDY)
    (folder / 'tune.toml').write_text(TUNE)
    (folder / 'yard.world.toml').write_text(WORLD.replace('[5, 2]', '[6, 2]'))
    begun = folder / 'begun'
    begun.mkdir()
    (begun / 'study.toml').write_text(STUDY)
    (begun / 'world.world.toml').write_text(WORLD)
    (begun / 'rig.json').write_bytes((ROOT / 'datasets/rigs/nominal.rig.json').read_bytes())
    (folder / 'room.ply').write_text(room())
    (folder / 'views.jsonl').write_text(features())
    write_seen(folder)
    characterise_test.write_sequence(folder)
    (folder / 'known.map').write_bytes(map_file(features().splitlines()))


PAIR = ['--left', 'left.pgm', '--right', 'right.pgm']
JUDGE = ['evaluate', *PAIR, '--truth', 'truth.pgm', '--truth-scale', '4', '--max-disparity', '20']


def calls():
    pair = PAIR
    board = ['--observations', 'corners.csv', '--size', '640x480']
    images = ['--left', 'left0[1-3].jpg', '--right', 'right0[1-3].jpg', '--board', '9x6', '--square-m', '0.025']

    def own(name):
        return f'{PYTHON} {ROOT}/docs/examples/{name}.py'
    return [
        Call('doctor', ['doctor'], []),
        Call('detect', ['detect', '--left', 'left01.jpg', '--right', 'right01.jpg', '--board', '9x6',
                        '-o', 'out.vnl'], ['out.vnl']),
        Call('match', ['match', *pair, '--prior', 'rig.json', '--picture', 'out.png', '-o', 'out.csv'],
             ['out.png', 'out.csv']),
        Call('calibrate', ['calibrate', *board, '--no-model-check', '-o', 'out.json'], ['out.json']),
        Call('calibrate_pairs', ['calibrate', '--pairs', 'pairs.csv', '--prior', 'rig.json',
                                 '-o', 'out.json'], ['out.json']),
        Call('calibrate_images', ['calibrate', *images, '--no-model-check', '--no-effects', '-o',
                                  'out.json'], ['out.json']),
        Call('combine', ['combine', '--prior', 'rig.json', 'pairs.csv', '--monitor', '--drift',
                         'drift.csv', '-o', 'out.json'], ['out.json', 'drift.csv']),
        Call('check', ['check', *board, '--trials', '40'], []),
        Call('uncertainty', ['uncertainty', 'rig.json', '--distances-m', '1,inf', '--grid', '6x4',
                             '-o', 'out'], ['out']),
        Call('uncertainty_samples', ['uncertainty', 'rig.json', '--samples', '50', '--distances-m', '2',
                                     '--grid', '6x4', '-o', 'out'], ['out']),
        Call('sample', ['sample', 'nominal', '-n', '2000', '-o', 'out.csv'], ['out.csv']),
        Call('convert', ['convert', 'rig.json', '--to', 'mrcal', '-o', 'models/'], ['models']),
        Call('convert_file', ['convert', 'rig.json', '--to', 'kalibr', '-o', 'out.yaml'], ['out.yaml']),
        Call('convert_back', ['convert', 'rig.yml', '-o', 'out.json'], ['out.json']),
        Call('diff', ['diff', 'nominal', 'nominal'], []),
        Call('advise', ['advise', 'nominal', '--reduce', 'depth', '--at-m', '5'], []),
        Call('plan', ['plan', 'nominal', '--depth-error', '0.02@5m'], []),
        Call('rectify', ['rectify', '--rig', 'rig.json', *pair, '-o', 'out'], ['out']),
        Call('stereo', ['stereo', '--rig', 'rig.json', *pair, '--max-disparity', '20', '--picture',
                        'out.png', '-o', 'out'], ['out', 'out.png']),
        Call('evaluate', [*JUDGE, '--matcher', 'edge', '-o', 'out'], ['out']),
        Call('evaluate_program', [*JUDGE, '--matcher', 'none', '--command',
                                  'sh matcher.sh {left} {right} {output}', '-o', 'out'], ['out']),
        Call('characterise', ['characterise', '--left', 'big_left.pgm', '--right', 'big_right.pgm',
                              '--truth', 'big_truth.pgm', '--truth-scale', '4', '--max-disparity',
                              '20', '-o', 'out.toml'], ['out.toml']),
        Call('characterise_sequence', [*characterise_test.SEQUENCE, '-o', 'out.toml'], ['out.toml']),
        Call('world', ['world', 'make', '--seed', '7', '-o', 'out.toml'], ['out.toml']),
        Call('world_info', ['world', 'info', 'posts.world.toml'], []),
        Call('world_sets', ['world', 'sets', 'posts.world.toml', '-o', 'out.toml'], ['out.toml']),
        Call('world_import', ['world', 'import', 'room.ply', '-o', 'out.toml', '--plan', 'out.svg'],
             ['out.toml', 'out.svg']),
        Call('world_build', ['world', 'build', '--segments', 'seen.segments', '--poses', 'seen.csv',
                             '--depth', 'seen*.png', '--rig', 'K.txt', '-o', 'out.toml', '--lines',
                             'out.csv', '--plan', 'out.svg'], ['out.toml', 'out.csv', 'out.svg']),
        Call('world_export', ['world', 'export', 'workshop', '-o', 'out.ply'], ['out.ply']),
        Call('world_view', ['world', 'view', 'workshop', '--poses', '3', '-o', 'out.html'], ['out.html']),
        Call('world_route', ['world', 'route', 'workshop', '-o', 'out.toml'], ['out.toml']),
        Call('simulate', ['simulate', '--world', 'workshop', '--rig', 'nominal', '--pose', '10,7.5,0',
                          '--picture', 'out.svg'], ['out.svg']),
        Call('simulate_views', ['simulate', '--world', 'posts.world.toml', '--rig', 'depth.rig.json',
                                '--poses', 'inside.csv', '--height-m', '1.2', '--features', 'out.jsonl',
                                '--segments', 'out.segments'], ['out.jsonl', 'out.segments']),
        Call('drive', ['drive', '--pose', '10,7.5,0', '--commands', 'commands.csv', '-o', 'out.jsonl',
                       '--truth', 'out.txt', '--plan', 'out.svg'], ['out.jsonl', 'out.txt', 'out.svg']),
        Call('drive_program', ['drive', '--pose', '10,7.5,0', '--command',
                               own('robot_controller'), '--steps', '4', '-o', 'out.jsonl',
                               '--odometry', 'out.txt'], ['out.jsonl', 'out.txt']),
        Call('servo', ['servo', '--trials', '1', '--threads', '1', '-o', 'out.csv', '--plan', 'out.svg'],
             ['out.csv', 'out.svg']),
        Call('servo_program', ['servo', '--trials', '1', '--threads', '1', '--source',
                               'command=' + own('own_source'), '-o', 'out.csv'], ['out.csv']),
        Call('render', ['render', '--world', 'posts.world.toml', '--pose', '3,2,90', '--samples', '1',
                        '-o', 'out'], ['out']),
        Call('study', ['study', 'study.toml', '-o', 'out', '--threads', '1'], ['out']),
        Call('study_program', ['study', 'own.toml', '-o', 'out', '--threads', '1'], ['out']),
        Call('tune', ['tune', 'tune.toml', '-o', 'out', '--threads', '1'], ['out']),
        # A study without results, which the program alone can make: it says so.
        Call('study_status', ['study', 'status', 'begun'], []),
        Call('study_merge', ['study', 'merge', 'begun', '-o', 'out'], ['out'], code=3),
        Call('export', ['export', 'begun', '-o', 'out.csv'], ['out.csv'], code=3),
        Call('study_status_whole', ['study', 'status', 'whole'], []),
        Call('study_merge_parts', ['study', 'merge', 'parts', '-o', 'out'], ['out']),
        Call('export_cells', ['export', 'whole', '--settings', '-o', 'out.csv'], ['out.csv']),
        Call('export_trials', ['export', 'parts', '--trials', '-o', 'out.npy'], ['out.npy']),
        Call('lines', ['lines', '--image', 'left.pgm', '--depth', 'depth.png', '--rig', 'rig.json',
                       '--segments', 'out.segments', '-o', 'out.jsonl'], ['out.segments', 'out.jsonl']),
        Call('map', ['map', 'make', '--features', 'views.jsonl', '--rig', 'nominal', '-o', 'out.map'],
             ['out.map']),
        Call('map_extend', ['map', 'make', '--features', 'views.jsonl', '--rig', 'nominal', '--extend',
                            'grown.map'], ['grown.map'], changes={'grown.map': 'known.map'}),
        Call('map_world', ['map', 'make', '--world', 'posts.world.toml', '--spacing-m', '2', '--corners',
                           '-o', 'out.map'], ['out.map']),
        Call('map_info', ['map', 'info', 'known.map'], []),
        # A few lines only: it would be unsure.
        Call('localise', ['localise', 'known.map', '--features', 'views.jsonl', '--rig', 'nominal',
                          '--max-error-rate', '1', '-o', 'out.csv'], ['out.csv']),
        Call('localise_world', ['localise', 'workshop.map', '--world', 'workshop', '-n', '3', '-o',
                                'out.csv'], ['out.csv']),
        Call('localise_program', ['localise', 'known.map', '--features', 'views.jsonl', '--rig', 'nominal',
                                  '--method', 'program', '--command', own('own_localiser'), '-o',
                                  'out.csv'], ['out.csv']),
        Call('odometry', ['odometry', '--world', 'workshop', '--leg', '2', '-o', 'out.txt'],
             ['out.txt']),
        Call('report', ['report', 'nominal', '--no-proof', '-o', 'out.html'], ['out.html']),
        Call('report_study', ['report', 'whole', '--no-proof', '--figures', 'out', '-o', 'out.html'],
             ['out.html', 'out']),
        Call('report_evaluation', ['report', 'judged', '-o', 'out.html'], ['out.html']),
    ]


class ProgramCase(unittest.TestCase):
    """Tests that call the program in a folder of their own with the inputs of calls()."""
    program = None
    first_words = ()

    def setUp(self):
        keeper = tempfile.TemporaryDirectory()
        self.addCleanup(keeper.cleanup)
        self.folder = pathlib.Path(keeper.name)
        write_inputs(self.folder)

    def run_program(self, *words):
        return subprocess.run([self.program, *self.first_words, *map(str, words)],
                              capture_output=True, text=True, cwd=self.folder, timeout=120)

    def done(self, *words, code=0):
        """What the program prints at this exit code."""
        run = self.run_program(*words)
        self.assertEqual(run.returncode, code, run.stderr)
        return run.stdout

    def refused(self, *words, says):
        """Bad input: one line that says so, and nothing written."""
        before = sorted(self.folder.rglob('*'))
        run = self.run_program(*words)
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
        self.assertIn(says, run.stderr)
        self.assertEqual(sorted(self.folder.rglob('*')), before)
