#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""The scripts that measure what building, testing and the demo cost, and check it."""
import contextlib
import importlib.util
import io
import json
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "scripts"


def load_check():
    """scripts/check_build_cost.py as a module."""
    spec = importlib.util.spec_from_file_location("check", SCRIPTS / "check_build_cost.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class InFolder(unittest.TestCase):
    """Tests with a folder of their own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name).resolve()

    def bash(self, text, *arguments):
        """Runs bash in the folder."""
        return subprocess.run(["bash", "-euo", "pipefail", "-c", text, "bash", *arguments],
                              cwd=self.folder, capture_output=True, text=True, check=False)


class MeasuredCompile(InFolder):
    """The compiler launcher, before commands that act as compilers."""

    def launch(self, *command):
        """Runs the launcher; returns the exit code and the log's lines as fields."""
        log = self.folder / "log.tsv"
        run = subprocess.run([SCRIPTS / "measured_compile.sh", log, *command], cwd=self.folder,
                             check=False)
        lines = log.read_text(encoding="utf-8").splitlines() if log.exists() else []
        return run.returncode, [line.split("\t") for line in lines]

    def test_says_what_a_unit_cost(self):
        busy = "i=0; while [ $i -lt 200000 ]; do i=$((i + 1)); done"
        code, lines = self.launch("sh", "-c", busy, "-o", "a b.o", "-c", "a b.cpp")
        self.assertEqual(code, 0)
        self.assertEqual(lines[0][1:], ["compiled", "a b.o", "a b.cpp"])
        self.assertRegex(lines[0][0], r"^\d+\.\d\d$")
        self.assertGreater(float(lines[0][0]), 0.02)

    def test_tells_hits_of_the_cache(self):
        for word, outcome in (("direct_cache_hit", "cached"), ("preprocessed_cache_hit", "cached"),
                              ("cache_miss", "compiled")):
            cache = f"printf '# a.cpp\\n{word}\\n' >>\"$CCACHE_STATSLOG\""
            _, lines = self.launch("sh", "-c", cache, "-o", "a.o", "-c", "a.cpp")
            self.assertEqual(lines[-1][1], outcome)

    def test_keeps_the_exit_code(self):
        code, lines = self.launch("sh", "-c", "exit 3", "-o", "a.o", "-c", "a.cpp")
        self.assertEqual((code, lines[0][1]), (3, "failed"))

    def test_leaves_other_calls_alone(self):
        self.assertEqual(self.launch("sh", "-c", "exit 4"), (4, []))

    def test_parallel_units_do_not_mix_their_lines(self):
        run = self.bash('for i in $(seq 40); do "$0" log true -o "object$i" -c source & done; wait'
                        .replace("$0", str(SCRIPTS / "measured_compile.sh")))
        self.assertEqual(run.returncode, 0, run.stderr)
        lines = (self.folder / "log").read_text(encoding="utf-8").splitlines()
        self.assertEqual(sorted(line.split("\t")[2] for line in lines),
                         sorted(f"object{i}" for i in range(1, 41)))


class BuildCost(InFolder):
    """The check of what the log holds."""

    def write(self, costs, units=("rig.o", "pose.o")):
        """A build folder whose log holds these costs."""
        build = self.folder / "build"
        build.mkdir(exist_ok=True)
        (build / "compile_costs.tsv").write_text("".join(
            f"{seconds}\t{outcome}\t{unit}\t{source}\n"
            for seconds, outcome, unit, source in costs), encoding="utf-8")
        (build / "compile_commands.json").write_text(json.dumps(
            [{"command": f"c++ -isystem /usr/include/eigen3 -o {unit} -c x.cpp"} for unit in units]),
            encoding="utf-8")
        return build

    def check(self, costs, exceptions="", units=("rig.o", "pose.o"), reference=None, again=None,
              **options):
        """The exit code of the check and what it printed; calib/camera/rig.cpp is one unit of two.

        `reference` is what the reference unit costs here, and `again` what the units cost when they
        are compiled again: as before, unless given.
        """
        build = self.write(costs, units)
        check = load_check()
        now = {unit: seconds for seconds, outcome, unit, _ in costs if outcome == "compiled"}
        now.update(again or {})

        def compile_s(command):
            words = command[0]
            if words[-1] == check.REFERENCE:
                return reference or check.REFERENCE_S
            return now[words[words.index("-o") + 1]]

        check.compile_s = compile_s
        check.EXCEPTIONS = self.folder / "exceptions.txt"
        check.EXCEPTIONS.write_text(exceptions, encoding="utf-8")
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            try:
                code = check.check(build, 0, **options)
            except check.Unusable as problem:
                return 2, printed.getvalue() + str(problem)
        return code, printed.getvalue()

    def command(self, *arguments):
        """The exit code of the script as a program, and what it printed."""
        run = subprocess.run([SCRIPTS / "check_build_cost.py", *arguments], capture_output=True,
                             text=True, check=False)
        return run.returncode, run.stdout + run.stderr

    RIG = str(ROOT / "calib/camera/rig.cpp")
    POSE = str(ROOT / "calib/pose.cpp")

    def test_names_the_dear_unit(self):
        code, said = self.check([(12.01, "compiled", "rig.o", self.RIG),
                                 (11.99, "compiled", "pose.o", self.POSE)])
        self.assertEqual(code, 1)
        self.assertIn("compilation too slow: calib/camera/rig.cpp", said)
        self.assertNotIn("slow: calib/pose.cpp", said)
        self.assertIn("2 of 2 units measured", said)

    def test_a_slow_machine_makes_no_unit_dear_and_a_fast_one_hides_none(self):
        pose = (3, "compiled", "pose.o", self.POSE)
        at_limit = [(23.9, "compiled", "rig.o", self.RIG), pose]
        self.assertEqual(self.check(at_limit)[0], 1)
        code, said = self.check(at_limit, reference=12)
        self.assertEqual(code, 0, said)
        self.assertIn("one second of the limits is 2.00 CPU s here", said)
        self.assertEqual(self.check([(6.1, "compiled", "rig.o", self.RIG), pose], reference=3)[0], 1)

    def test_a_unit_is_dear_twice_or_not_at_all(self):
        costs = [(15, "compiled", "rig.o", self.RIG), (1, "compiled", "pose.o", self.POSE)]
        for again, wanted in ((11.9, 0), (12.1, 1), (30, 1)):
            code, said = self.check(costs, again={"rig.o": again})
            self.assertEqual(code, wanted, said)
        self.assertIn("calib/camera/rig.cpp: 15.0 s", said)

    def test_a_unit_is_compiled_again_beside_the_build(self):
        check = load_check()
        source = self.folder / "x.cpp"
        source.write_text("int x;\n", encoding="utf-8")
        command = (["c++", "-MD", "-MF", "x.d", "-o", "x.o", "-c", "x.cpp"], str(self.folder))
        self.assertGreater(check.compile_s(command), 0)
        self.assertEqual(list(self.folder.iterdir()), [source])
        source.write_text("int x\n", encoding="utf-8")
        with self.assertRaisesRegex(check.Unusable, "x.cpp does not compile: .*expected"):
            check.compile_s(command)

    def test_the_last_compilation_in_earnest_counts(self):
        code, said = self.check([(30, "compiled", "rig.o", self.RIG),
                                 (2, "compiled", "rig.o", self.RIG),
                                 (40, "failed", "rig.o", self.RIG),
                                 (0.01, "cached", "rig.o", self.RIG),
                                 (0.01, "cached", "pose.o", self.POSE)], allow_cached=True)
        self.assertEqual(code, 0, said)
        self.assertIn("1 of 2 units measured, 2 CPU s in total; 1 found only in the compiler", said)
        self.assertIn("not measured: 1 units came from the compiler cache", said)

    def test_removed_units_and_batches_do_not_count(self):
        code, said = self.check([
            (30, "compiled", "gone.o", self.RIG),
            (2, "compiled", "rig.o", self.RIG),
            (30, "compiled", "unity.o", str(self.folder / "build/Unity/unity_0_cxx.cxx"))],
            units=("rig.o", "unity.o"))
        self.assertEqual(code, 0, said)
        self.assertIn("1 of 2 units measured", said)
        self.assertIn("unity build batches excluded: 1", said)

    def test_too_few_units_measured_is_no_pass(self):
        units = [f"{i}.o" for i in range(20)]
        measured = [(1, "compiled", unit, self.RIG) for unit in units]
        cached = [(0.01, "cached", unit, self.RIG) for unit in units]
        self.assertEqual(self.check(measured[:18], units=units)[0], 0)  # 90 %
        later = [f"tests/CMakeFiles/{part}.dir/{i}.o" for part in ("calib_sanitized", "vernier_sanitized_headers")
                 for i in range(5)]
        self.assertEqual(self.check(measured[:18], units=units + later)[0], 0)
        self.assertEqual(self.check(measured[:18], units=units + ["tests/CMakeFiles/calib_test.dir/1.o"])[0], 2)
        code, said = self.check(measured[:17] + cached[17:], units=units)
        self.assertEqual(code, 2)
        self.assertIn("too few units were measured: 17 of 20, 90% are needed", said)
        for costs, wanted in ((measured[:17] + cached[17:], 0), (measured[:10] + cached[10:17], 2)):
            self.assertEqual(self.check(costs, units=units, allow_cached=True)[0], wanted)
        for costs in ([], [(30, "compiled", "gone.o", self.RIG)],
                      [(30, "compiled", "1.o", str(self.folder / "build/Unity/unity_0_cxx.cxx"))]):
            self.assertEqual(self.check(costs, units=units)[0], 2)
        dear = [(30, "compiled", "1.o", self.RIG)]
        self.assertEqual(self.check(dear, units=units)[0], 1)  # a dear unit is one in any case

    def test_tolerance_raises_the_limits(self):
        at_limit = [(18.0, "compiled", "rig.o", self.RIG), (1, "compiled", "pose.o", self.POSE)]
        self.assertEqual(self.check(at_limit, tolerance=50)[0], 0)
        self.assertEqual(self.check(at_limit, tolerance=49)[0], 1)
        above = [(18.01, "compiled", "rig.o", self.RIG), (1, "compiled", "pose.o", self.POSE)]
        self.assertEqual(self.check(above, tolerance=50)[0], 1)
        excepted = "calib/camera/rig.cpp 16 kernels\n"
        for seconds, wanted in ((24, 0), (24.01, 1)):
            costs = [(seconds, *at_limit[0][1:]), at_limit[1]]
            self.assertEqual(self.check(costs, excepted, tolerance=50)[0], wanted)

    def test_the_command_line(self):
        # An object of no source of the checkout: the exceptions of the checkout say nothing of it.
        build = self.write([(0.01, "compiled", "rig.o", "/far/rig.cpp"),
                            (0.01, "cached", "pose.o", "/far/pose.cpp")])
        code, said = self.command("--allow-cached", "--tolerance", "50", build, "--top", "1")
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"0\.0\d s  /far/rig.cpp  \(rig.o\)")
        self.assertIn("not measured: 1 units came from the compiler cache", said)
        empty = self.write([])
        code, said = self.command(empty, "--tolerance", "50")
        self.assertEqual(code, 2)
        self.assertIn("check_build_cost.py: too few units were measured", said)
        self.assertEqual(self.command("--help")[0], 0)
        for bad in (["--top"], ["--tolerance", "x"], ["--other"], ["a", "b"]):
            self.assertEqual(self.command(*bad)[0], 2, bad)
        code, said = self.command(self.folder / "none")
        self.assertEqual(code, 2)
        self.assertIn("build with -DVERNIER_MEASURE_BUILD=ON first", said)

    def test_exceptions(self):
        pose = (1, "compiled", "pose.o", self.POSE)
        dear = [(15, "compiled", "rig.o", self.RIG), pose]
        self.assertEqual(self.check(dear, "calib/camera/rig.cpp 16 kernels\n")[0], 0)
        self.assertEqual(self.check(dear, "calib/camera/rig.cpp 14 kernels\n")[0], 1)
        code, said = self.check([(3, "compiled", "rig.o", self.RIG), pose],
                                "calib/camera/rig.cpp 16 kernels\n")
        self.assertEqual(code, 0)
        self.assertIn("warning: exceptions.txt: calib/camera/rig.cpp takes 3.0 s", said)
        code, said = self.check(dear, "calib/camera/rig.cpp 16 kernels\ncalib/none.cpp 16 kernels\n")
        self.assertEqual(code, 1)
        self.assertIn("calib/none.cpp does not exist", said)
        for bad in ("calib/camera/rig.cpp 16", "calib/camera/rig.cpp much of it", "calib/camera/rig.cpp 11 is within",
                    "calib/camera/rig.cpp 16 one\ncalib/camera/rig.cpp 17 two"):
            self.assertEqual(self.check(dear, bad)[0], 2, bad)

    def test_the_exceptions_of_this_checkout_can_be_read(self):
        check = load_check()
        for source in check.read_exceptions(check.EXCEPTIONS):
            self.assertTrue((ROOT / source).is_file(), source)


class Demo(InFolder):
    """scripts/demo.sh between programs that do nothing."""

    def test_searches_again_what_a_build_folder_was_set_up_without(self):
        for name in ("scripts", "bin", "build/release"):
            (self.folder / name).mkdir(parents=True)
        (self.folder / "build/release/build.ninja").touch()
        for name in ("demo.sh", "part_times.sh"):
            (self.folder / "scripts" / name).write_bytes((SCRIPTS / name).read_bytes())
        for name, text in (("scripts/install_packages.sh", ""), ("build/release/vernier", ""),
                           ("bin/cmake", f"echo \"$*\" >>{self.folder}/calls")):
            (self.folder / name).write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
            (self.folder / name).chmod(0o755)
        run = self.bash('PATH=$PWD/bin:$PATH bash scripts/demo.sh')
        self.assertEqual(run.returncode, 0, run.stderr)
        calls = (self.folder / "calls").read_text(encoding="utf-8").splitlines()
        self.assertEqual(calls[0], "build/release")  # configures, with the settings that it has
        self.assertIn("--target vernier_program", calls[1])


class Parts(InFolder):
    """Times of a script's parts, and the demo's budget."""

    def test_pieces_add_up(self):
        run = self.bash('''. "$1"
            begin_part packages
            begin_part "run: first"; sleep 0.1
            begin_part "run: second"; for ((i = 0; i < 100000; i++)); do :; done | cat
            end_parts
            write_part_times >times.txt
            print_part_times''', str(SCRIPTS / "part_times.sh"))
        self.assertEqual(run.returncode, 0, run.stderr)
        rows = [line.split("\t")
                for line in (self.folder / "times.txt").read_text(encoding="utf-8").splitlines()]
        self.assertEqual([row[0] for row in rows],
                         ["packages", "run", "run: first", "run: second", "total"])
        wall = {name: float(seconds) for name, seconds, _ in rows}
        cpu = {name: float(seconds) for name, _, seconds in rows}
        self.assertGreaterEqual(wall["run: first"], 0.09)
        self.assertAlmostEqual(wall["run"], wall["run: first"] + wall["run: second"], places=6)
        self.assertGreaterEqual(wall["total"], wall["run"])
        self.assertGreater(cpu["run: second"], 0.02)  # of a process that it waited for
        self.assertGreaterEqual(cpu["total"], cpu["run"])

    def budget(self, packages, build, total):
        """The exit code of the check of such times."""
        times = self.folder / "times.txt"
        times.write_text(f"packages\t{packages}\t1.00\nbuild\t{build}\t1.00\n"
                         f"total\t{total}\t2.00\n", encoding="utf-8")
        return subprocess.run([SCRIPTS / "check_demo_cost.sh", times], capture_output=True,
                              check=False).returncode

    def test_the_demo_has_a_budget(self):
        self.assertEqual(self.budget("0.08", "1.00", "9.09"), 0)
        self.assertEqual(self.budget("9999.00", "1.00", "9.00"), 1)
        self.assertEqual(self.budget("1.00", "1.00", "9999.00"), 1)
        self.assertEqual(self.budget("1.00", "", "9.00"), 2)


if __name__ == "__main__":
    unittest.main()
