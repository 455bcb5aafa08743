# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""What the report's page says of itself: report_test.py PROGRAM."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

PROGRAM = None
ROOT = pathlib.Path(__file__).resolve().parents[2]
STUDY = '''[study]
trials = 2
protocol = "near_path"
[map]
spacing_m = 2
'''


class Report(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def works(self, *words, **more):
        done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, cwd=self.folder,
                              **more)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def data(self):
        text = (self.folder / 'report.html').read_text()
        found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)
        return json.loads(found[1])

    def page_with_plots(self):
        built = pathlib.Path(PROGRAM).parent / 'share/vernier/page'
        if not (built / 'plotly.js').exists():
            self.skipTest('this build has no plots')
        return built

    def test_commands_are_those_that_were_typed(self):
        (self.folder / 'small.toml').write_text(STUDY)
        for shard in ('0/2', '1/2'):
            self.works('study', 'small.toml', '-o', 'my results', '-q', '--shard', shard)
        self.works('report', 'my results', '--no-proof', '--title', "it's", '-o', 'report.html')
        data = self.data()
        self.assertEqual(data['program']['command'], "vernier report 'my results' --no-proof --title"
                         " 'it'\\''s' -o report.html")
        self.assertIn("vernier study small.toml -o 'my results' -q --shard 0/2",
                      data['study']['commands'])
        self.works('study', 'merge', 'my results', '-o', 'all')
        self.works('report', 'all', '--no-proof', '-o', 'report.html')
        self.assertIn("vernier study merge 'my results' -o all", self.data()['study']['commands'])

    def test_a_source_that_fails_draws_nothing_sensed(self):
        shutil.copy(ROOT / 'docs/examples/own_source.py', self.folder)
        wrapper = self.folder / 'source.py'
        wrapper.write_text('import os, runpy, sys\n'
                           'if os.path.exists("broken"): sys.exit("no sensor today")\n'
                           'runpy.run_path("own_source.py", run_name="__main__")\n')
        (self.folder / 'small.toml').write_text(
            STUDY + f'[sources]\ncommand = "{sys.executable} source.py"\n')
        self.works('study', 'small.toml', '-o', 'results', '-q')
        self.works('report', 'results', '--no-proof', '-o', 'report.html')
        view = self.data()['view']
        self.assertGreater(len(view['sensed']), 20)
        self.assertRegex(view['words'], r'[0-9]+ sensed after applying all error sources\.$')
        (self.folder / 'broken').touch()
        self.works('report', 'results', '--no-proof', '-o', 'report.html')
        view = self.data()['view']
        self.assertEqual(view['sensed'], [])
        self.assertIn('What was sensed is not shown, since a source of error failed: ', view['words'])
        self.assertIn('no sensor today', view['words'])

    def test_several_studies_share_a_page(self):
        for name, seed in (('one', 1), ('two', 2)):
            (self.folder / f'{name}.toml').write_text(STUDY.replace('trials = 2',
                                                                    f'trials = 2\nseed = {seed}'))
            self.works('study', f'{name}.toml', '-o', name, '-q')
        self.works('report', 'one', 'two', '--no-proof', '-o', 'report.html')
        data = self.data()
        self.assertEqual([part['name'] for part in data['studies']], ['one', 'two'])
        self.assertEqual([part['study']['seed'] for part in data['studies']], [1, 2])
        self.assertNotIn('study', data)
        self.assertEqual(len(data['rigs']), 1)  # both have the same
        for part in data['studies']:
            machine, = part['study']['machines']
            self.assertRegex(machine, r'^vernier [\d.]+, .+, \d+ cores?, \S+$')
            self.assertEqual(len(part['study']['commands']), 1)
        self.assertEqual(data['program']['machine'], machine)

    def test_cells_of_several_worlds_have_each_its_own(self):
        for seed, size in ((1, '10,8,2.5'), (2, '14,10,2.5')):
            self.works('world', 'make', '--seed', str(seed), '--size-m', size, '-o', f'{seed}.world.toml')
        (self.folder / 'small.toml').write_text(
            STUDY + '[sweep]\n"world.file" = ["1.world.toml", "2.world.toml"]\n"sources.calibration" = [1, 2]\n')
        self.works('study', 'small.toml', '-o', 'out', '-q')
        self.works('report', 'out', '--no-proof', '-o', 'report.html')
        data = self.data()
        self.assertEqual(len(data['worlds']), 2)
        for cell in data['study']['cells']:
            world = data['worlds'][cell['world']]
            seed = cell['swept']['world.file'][0]
            self.assertEqual(max(x for s in world['segments'] for x in (s[0], s[3])), {'1': 10, '2': 14}[seed])
            for query in cell['trial_list']:
                self.assertLess(query[1], {'1': 10, '2': 14}[seed])
        (self.folder / 'one.toml').write_text(STUDY)
        self.works('study', 'one.toml', '-o', 'one', '-q')
        self.works('report', 'one', '--no-proof', '-o', 'report.html')
        self.assertNotIn('worlds', self.data())

    def check_pdf_programs(self):
        """rsvg-convert's exit code alone does not say that there is a PDF file."""
        (self.folder / 'bin').mkdir()
        fake = self.folder / 'bin' / 'rsvg-convert'
        environment = dict(os.environ, PATH=f'{fake.parent}:{os.environ["PATH"]}')
        whole = b'%PDF-1.5\n1 0 obj\n%%EOF\n'
        for given, is_whole in ((whole, True), (None, False), (b'', False), (whole[:-3], False),
                                (b'<svg/>\n%%EOF\n', False)):
            (self.folder / 'given').write_bytes(given or b'')
            copy = f'cp "{self.folder / "given"}" "${{2#--output=}}"'
            fake.write_text(f'#!/bin/sh\n{":" if given is None else copy}\n')
            fake.chmod(0o755)
            done = subprocess.run(
                [PROGRAM, 'report', 'grid', '--no-proof', '-o', 'fake.html', '--figures', 'faked'],
                capture_output=True, text=True, cwd=self.folder, env=environment)
            self.assertEqual(done.returncode, 0 if is_whole else 2, done.stderr)
            if not is_whole:
                self.assertIn('rsvg-convert: gave no whole PDF file; leave out --figures', done.stderr)
                continue
            self.assertEqual((self.folder / 'faked' / 'success.pdf').read_bytes(), whole)

    def test_figures_for_papers(self):
        (self.folder / 'grid.toml').write_text(STUDY + '''[sweep]
"sources.calibration" = [0.1, 10]
"localiser.method" = ["lines", "pgh_baseline_vectorised"]
''')
        self.works('study', 'grid.toml', '-o', 'grid', '-q')
        done = self.works('report', 'grid', '--no-proof', '-o', 'report.html', '--figures', 'figures',
                          '--json')
        files = [pathlib.Path(name) for name in json.loads(done.stdout)['figures']]
        has_pdf = shutil.which('rsvg-convert') is not None
        self.assertEqual('rsvg-convert' in done.stderr, not has_pdf)
        self.assertEqual([f.name for f in files if f.suffix == '.svg'],
                         ['success.svg', 'median_error.svg'])
        self.assertEqual(len(files), 4 if has_pdf else 2)
        for name in files:
            content = (self.folder / name).read_bytes()
            if name.suffix == '.pdf':
                self.assertTrue(content.startswith(b'%PDF-') and content.rstrip().endswith(b'%%EOF'))
                continue
            tree = xml.etree.ElementTree.fromstring(content)
            texts = [''.join(text.itertext()).strip()
                     for text in tree.iter('{http://www.w3.org/2000/svg}text')]
            self.assertIn('ψc', texts)
            for method in ('lines', 'pgh_baseline_vectorised'):
                self.assertIn(f'method = {method}', texts)  # a panel each
            self.assertNotIn(b'nan', content)
        self.check_pdf_programs()
        done = subprocess.run([PROGRAM, 'report', 'nominal', '--figures', 'none', '-o', 'x.html'],
                              capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn('no study is given', done.stderr)
        self.assertFalse((self.folder / 'none').exists() or (self.folder / 'x.html').exists())

    def test_results_without_a_command_say_none(self):
        self.works('report', 'nominal', '--no-proof', '-o', 'report.html')
        self.assertEqual(self.data()['program']['command'],
                         'vernier report nominal --no-proof -o report.html')
        self.assertNotIn('study', self.data())

    def test_a_bound_that_holds_is_not_called_too_small(self):
        done = self.works('report', 'nominal', '-o', 'report.html')
        rig, = self.data()['rigs']
        self.assertTrue(rig['true_bound'])
        self.assertEqual(rig['calibration']['warnings'], [])
        self.assertNotIn('too small', done.stderr)

    def test_a_page_without_plots_is_said(self):
        built = self.page_with_plots()
        page = self.folder / 'share/page'
        page.mkdir(parents=True)
        for name in ('report.html', 'report.css', 'report.js'):
            (page / name).symlink_to(built / name)
        call = ('report', 'nominal', '--no-proof', '-o', 'report.html', '--json')
        done = self.works(*call)
        self.assertTrue(json.loads(done.stdout)['plots'])
        self.assertNotIn('plots', done.stderr)
        without = dict(os.environ, VERNIER_SHARE=str(self.folder / 'share'))
        done = self.works(*call, env=without)
        self.assertFalse(json.loads(done.stdout)['plots'])
        self.assertIn('no plots', done.stderr)
        self.assertIn('pages have tables only; esbuild or plotly.js was missing',
                      self.works('doctor', env=without).stdout)

    def test_a_page_without_its_script_is_refused_before_any_work(self):
        built = pathlib.Path(PROGRAM).parent / 'share/vernier/page'
        page = self.folder / 'share/page'
        page.mkdir(parents=True)
        for name in ('report.html', 'report.css'):
            (page / name).symlink_to(built / name)
        without = dict(os.environ, VERNIER_SHARE=str(self.folder / 'share'))
        found = {finding['what']: finding for finding in
                 json.loads(self.works('doctor', '--json', env=without).stdout)['findings']}
        for what in ('report page', 'report plots (plotly)'):
            self.assertFalse(found[what]['found'], what)
            self.assertIn('run scripts/install_packages.sh', found[what]['value'])
        self.assertIn('esbuild was missing', found['report page']['value'])
        # This rig file is none, which the work on it would say.
        (self.folder / 'no_rig.json').write_text('{')
        done = subprocess.run([PROGRAM, 'report', 'no_rig.json', '-o', 'report.html'],
                              capture_output=True, text=True, cwd=self.folder, env=without)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn('this build has no page script because esbuild was missing',
                      done.stderr)
        self.assertFalse((self.folder / 'report.html').exists())

    def test_the_page_holds_the_licence_of_plotly(self):
        self.page_with_plots()
        self.works('report', 'nominal', '--no-proof', '-o', 'report.html')
        self.assertIn('Permission is hereby granted', (self.folder / 'report.html').read_text())


if __name__ == '__main__':
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
