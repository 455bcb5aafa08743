#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the number of views that `plan --success` names is the number that it takes.

    plan_success.py PROGRAM [--rigs 12] [--first-seed 1] [--within-m 0.05] [--trials 300]

Each seed draws a rig (focal length, baseline), a board (noise, distance, tilt) and an office. The
plan is made from the datasheet, for the success rate half way between those without calibration
error and with four times that of ten views; where these differ by less than a tenth, calibration
does not limit and the seed is passed over. Then it is done: a study of the same office and of
other trials calibrates anew, from simulated views, for every trial and every map, with numbers of
views around the plan's. The number reached is where its success rate, made monotone, crosses the
target. It lies within the plan's interval or not; so does the range in which the study's own limits
cross.
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]

STUDY = '''[study]
trials = {trials}
seed = {seed}
protocol = "path"
[system]
name = "localiser"
success_error = {within_m}
[world]
file = "w.world.toml"
[rig]
file = "rig.json"
[map]
spacing_m = 1
'''


class Trial:
    """One seed: its folder, its rig and its board."""

    def __init__(self, options, seed, folder):
        self.options, self.seed, self.folder = options, seed, folder
        draws = random.Random(seed)
        rig = json.loads((ROOT / 'docs/examples/datasheet.json').read_text())
        f_px, baseline_m = draws.uniform(400, 900), draws.uniform(0.08, 0.3)
        for camera in rig['cameras']:
            camera['parameters']['f_px'] = f_px
        rig['cameras'][1]['from_first']['translation_m'][0] = -baseline_m
        for key in ('parameter_names', 'parameters', 'covariance'):
            rig.pop(key, None)
        (folder / 'rig.json').write_text(json.dumps(rig))
        self.sigma_px = draws.uniform(0.1, 0.4)
        self.distance_m = draws.uniform(0.5, 1.1) * f_px / 500
        self.tilt_deg = draws.uniform(20, 45)
        self.about = (f'f {f_px:.0f} px, baseline {baseline_m:.2f} m, noise {self.sigma_px:.2f} px, '
                      f'board at {self.distance_m:.2f} m')
        self.call('world', 'make', '--seed', str(70000 + seed), '--size-m', '14,11,2.5', '-o',
                  'w.world.toml')

    def call(self, *words):
        done = subprocess.run([self.options.program, *words], cwd=self.folder, capture_output=True,
                              text=True)
        if done.returncode not in (0, 3):
            sys.exit(done.stderr)
        return done.stdout

    def study(self, seed, more=''):
        return STUDY.format(trials=self.options.trials, seed=seed, within_m=self.options.within_m) + more

    def plan(self, success):
        (self.folder / 'plan.toml').write_text(self.study(self.seed))
        return json.loads(self.call(
            'plan', '--study', 'plan.toml', '--board', '9x6', '--square-m', '0.025',
            '--board-distance-m', str(self.distance_m), '--board-tilt-deg', str(self.tilt_deg),
            '--pixel-sigma', str(self.sigma_px), '--success', f'{success:.4f}', '--json', '-q'))

    def done(self, views):
        text = self.study(1000 + self.seed, f'''[calibration]
board = "9x6"
square_m = 0.025
pixel_sigma_px = {self.sigma_px}
distance_m = {self.distance_m}
tilt_deg = {self.tilt_deg}
[sweep]
"calibration.views" = {views}
''')
        (self.folder / 'doing.toml').write_text(text)
        self.call('study', 'doing.toml', '-o', 'done', '-q')
        return json.loads(self.call('study', 'status', 'done', '--json'))['cells']


def rising(rates):
    """Isotonic regression of equal weights."""
    pools = []
    for rate in rates:
        pools.append([rate, 1])
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            rate, count = pools.pop()
            pools[-1] = [(pools[-1][0] * pools[-1][1] + rate * count) / (pools[-1][1] + count),
                         pools[-1][1] + count]
    return [rate for rate, count in pools for _ in range(count)]


def crossing(views, rates, target):
    """Where a rising rate reaches the target, linear in the logarithm; 0 before the first number,
    infinite beyond the last."""
    rates = rising(rates)
    for i, rate in enumerate(rates):
        if rate < target:
            continue
        if i == 0:
            return 0
        part = (target - rates[i - 1]) / (rate - rates[i - 1])
        return math.exp(math.log(views[i - 1]) + part * math.log(views[i] / views[i - 1]))
    return math.inf


def numbers(low, middle, high):
    wanted = [low / 2, low / 1.4, low, math.sqrt(low * middle), middle, math.sqrt(middle * high),
              high, 1.4 * high, 2 * high]
    return sorted({max(3, round(n)) for n in wanted})


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program', type=lambda name: str(pathlib.Path(name).resolve()))
    parser.add_argument('--rigs', type=int, default=12)
    parser.add_argument('--first-seed', type=int, default=1)
    parser.add_argument('--within-m', type=float, default=0.05)
    parser.add_argument('--trials', type=int, default=300)
    options = parser.parse_args()
    planned = within = overlaps = unknown = censored = 0
    ratios = []
    for seed in range(options.first_seed, options.first_seed + options.rigs):
        with tempfile.TemporaryDirectory() as name:
            trial = Trial(options, seed, pathlib.Path(name))
            curve = [row['success'] for row in trial.plan(0.5)['success']]
            if curve[0] - curve[-1] < 0.1:
                print(f'{seed}: {trial.about}: calibration does not limit, {curve[0]:.3f} to '
                      f'{curve[-1]:.3f}', flush=True)
                continue
            target = (curve[0] + curve[-1]) / 2
            plan = trial.plan(target)
            if plan['views'] is None or plan['views_interval'][1] is None:
                unknown += 1
                print(f'{seed}: {trial.about}: no interval of views for {target:.3f}', flush=True)
                continue
            low, high = plan['views_interval']
            cells = trial.done(numbers(low, plan['views'], high))
            views = [cell['swept']['calibration.views'] for cell in cells]
            reached = crossing(views, [cell['success'] for cell in cells], target)
            ends = [crossing(views, [cell['success_interval_95'][end] for cell in cells], target)
                    for end in (1, 0)]
        planned += 1
        # Three views are the fewest: what they reach is within an interval that begins there.
        inside = round(low) <= round(max(3, reached) if low <= 3 else reached) <= round(high)
        within += inside
        overlaps += ends[0] <= high and ends[1] >= low
        if 0 < reached < math.inf:
            ratios.append(reached / plan['views'])
        else:
            censored += 1
        text = ' '.join(f'{n}: {cell["success"]:.3f}' for n, cell in zip(views, cells))
        print(f'{seed}: {trial.about}: {100 * target:.1f} % takes {plan["views"]} [{low:.0f}, {high:.0f}] '
              f'views by the plan; {text}; reached at {reached:.1f} '
              f'[{ends[0]:.1f}, {ends[1]:.1f}]'
              f'{"" if inside else ", outside"}', flush=True)
    mean = math.exp(sum(map(math.log, ratios)) / len(ratios)) if ratios else math.nan
    print(f'{within} of {planned} reached within the interval, {overlaps} with the limits of the '
          f'study itself; reached / planned, geometric mean {mean:.2f} of {len(ratios)}, {censored} beyond the numbers tried; '
          f'no interval: {unknown}')


if __name__ == '__main__':
    main()
