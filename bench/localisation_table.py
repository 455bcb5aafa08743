#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The table of localisation: success, answers at a stated error rate and time, by protocol.

    bench/localisation_table.py build/release/vernier -o out/table                 # workshop
    bench/localisation_table.py build/release/vernier -o out/table --worlds 201-220 --trials 500

Runs one study a row (and world) and continues those that the folder holds. It prints how many
answers each state an error of at most the row's rate, and how many do together: the most, the
surest first, of which the mean of what they state is within it. Of generated worlds it prints
means over worlds with their 95 % interval by a bootstrap that resamples whole worlds. Needs only
the Python standard library. Times are CPU times of one thread a query.
"""
import argparse
import csv
import json
import pathlib
import random
import subprocess
import sys

# Name, protocol, headings a node (0: along the route), looks, stated error rate of the answers.
ROWS = (
    ("near_path, one look", "near_path", 0, 1, 0.001),
    ("near_path, a second look where unsure", "near_path", 0, 2, 0.0005),
    ("path, one look", "path", 0, 1, 0.005),
    ("anywhere, one look, eight headings", "anywhere", 8, 1, 0.01),
    ("anywhere, four looks, eight headings", "anywhere", 8, 4, 0.001),
    ("free, one look, eight headings", "free", 8, 1, 0.01),
)
STUDY = """[study]
trials = {trials}
seed = {seed}
protocol = "{protocol}"
[world]
file = "{world}"
[rig]
file = "nominal"
[map]
headings = {headings}
[localiser]
looks = {looks}
max_error_rate = {rate}
{looking}
[sources]
calibration = {psi_c}
{sources}
"""
FIGURES = ("best_guess_success", "median_error_m",
           "recall_0_5m_5deg", "recall_0_25m_2deg", "cpu_ms_mean", "cpu_ms_p95", "world_ceiling",
           "unaliased_share")


def study_of(row, world, options):
    name, protocol, headings, looks, rate = row
    return STUDY.format(trials=options.trials, seed=options.seed, protocol=protocol, world=world,
                        headings=headings or '"path"', looks=looks,
                        rate=max(rate, options.look_rate) if looks > 1 else rate,
                        looking=f"look_error_rate = {options.look_rate}" if looks > 1 else "",
                        psi_c=options.psi_c, sources=options.sources.replace(",", "\n"))


def run_study(program, text, folder, threads):
    """The cell of a study that is run, or gone on with, in a folder."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    file = folder.with_suffix(".toml")
    file.write_text(text, encoding="utf-8")
    run = subprocess.run([program, "study", file, "-o", folder, "--threads", str(threads), "--json",
                          "-q"], capture_output=True, text=True, check=False)
    if run.returncode not in (0, 3):
        sys.exit(f"{folder}: {run.stderr.strip()}")
    return json.loads(run.stdout)["cells"][0]


def world_files(program, options):
    """Name and file of each world."""
    if not options.worlds:
        file = pathlib.Path(options.world)  # or a shipped name
        return [(file.name.split(".")[0], file.resolve() if file.is_file() else options.world)]
    first, last = (int(x) for x in options.worlds.split("-"))
    made = []
    for seed in range(first, last + 1):
        file = options.output.resolve() / f"world{seed}.world.toml"
        if not file.exists():
            size = ["--size-m", options.size_m] if options.size_m else []
            subprocess.run([program, "world", "make", "--kind", options.kind, "--seed", str(seed),
                            *size, "-o", file], check=True,
                       stdout=subprocess.DEVNULL)
        made.append((f"world{seed}", str(file)))
    return made


def mean_and_interval(values, draws=4000):
    """Mean over worlds; percentiles of the means of worlds drawn with replacement, fixed seed."""
    if len(values) == 1:
        return values[0], values[0], values[0]
    generator = random.Random(1)
    means = sorted(sum(generator.choices(values, k=len(values))) / len(values) for _ in range(draws))
    return sum(values) / len(values), means[int(0.025 * draws)], means[int(0.975 * draws)]


def stated_answers(program, folders):
    """Stated error and whether it is right of every best guess, from sure to unsure."""
    guesses = []
    for folder in folders:
        file = folder / "trials.csv"
        subprocess.run([program, "export", folder, "--trials", "-o", file], check=True,
                       stdout=subprocess.DEVNULL)
        with open(file, encoding="utf-8", newline="") as rows:
            guesses += [(1 - float(row["probability"]), float(row["error_m"] or "inf") <= 1)
                        for row in csv.DictReader(rows)]
        file.unlink()
    return sorted(guesses)


def answers_that(guesses, is_meant):
    """How many answers, and how many of them right, and the last one's stated error: the longest
    start of the guesses of which `is_meant`, a function of the last and the mean stated error,
    holds."""
    most, stated, right = (0, 0, 0.0), 0, 0
    for answered, (error, is_right) in enumerate(guesses, 1):
        stated += error
        right += is_right
        if is_meant(error, stated / answered):
            most = answered, right, error
    return most


def print_row(name, rate, cells, guesses):
    trials = sum(cell["trials"] for cell in cells)
    parts = []
    for figure in FIGURES:
        values = [cell[figure] for cell in cells if cell.get(figure) is not None]
        if not values:
            continue
        scale = 100 if figure not in ("median_error_m", "cpu_ms_mean", "cpu_ms_p95") else 1
        mean, low, high = mean_and_interval([scale * x for x in values])
        text = f"{figure} {mean:.4g}"
        if len(values) > 1:
            text += f" [{low:.4g}, {high:.4g}]"
        elif figure == "best_guess_success" and cells[0]["success_interval_95"]:
            low, high = cells[0]["success_interval_95"]
            text += f" ({100 * low:.2f} to {100 * high:.2f} for those answered)"
        parts.append(text)
    relative = [100 * cell["best_guess_success"] / cell["world_ceiling"] for cell in cells
                if cell.get("world_ceiling")]
    if relative:
        mean, low, high = mean_and_interval(relative)
        parts.append(f"÷ ceiling {mean:.2f}" + (f" [{low:.2f}, {high:.2f}]" if len(cells) > 1 else ""))
    print(f"{name}: {trials} queries\n    " + "; ".join(parts), flush=True)
    for what, is_meant in (("each", lambda last, _: last <= rate),
                           ("together", lambda _, mean: mean <= rate)):
        answered, right, last = answers_that(guesses, is_meant)
        if answered:
            print(f"    answers that {what} state {rate:g} (threshold {last:.3g}): "
                  f"{100 * answered / trials:.2f} %, {right} of {answered} right, "
                  f"{100 * right / answered:.2f} %", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--world", default="workshop")
    parser.add_argument("--worlds", help="seeds of generated buildings, as 201-220")
    parser.add_argument("--kind", default="office", help="of generated buildings (world make)")
    parser.add_argument("--size-m", help="of generated buildings (default: what suits the kind)")
    parser.add_argument("--trials", type=int, default=10000, help="queries a row and world")
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--psi-c", type=float, default=1)
    parser.add_argument("--sources", default="", help="further settings, as 'edge_loss = 0.2'")
    parser.add_argument("--rows", default="", help="numbers of rows, as 1,3; default: all")
    parser.add_argument("--look-rate", type=float, default=0.005,
                        help="a further look where an error is more probable, in rows of several")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    worlds = world_files(options.program, options)
    chosen = [int(x) for x in options.rows.split(",")] if options.rows else range(1, len(ROWS) + 1)
    for number in chosen:
        row = ROWS[number - 1]
        folders = [options.output / f"row{number}_{name}" for name, _ in worlds]
        cells = [run_study(options.program, study_of(row, file, options), folder, options.threads)
                 for (_, file), folder in zip(worlds, folders)]
        print_row(row[0], row[4], cells, stated_answers(options.program, folders))


if __name__ == "__main__":
    main()
