#!/usr/bin/python3
"""The witness of the machine's pauses, and which failed rostests ran while it saw one."""
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rosunit

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"


def lines_of(file):
    return file.read_text(encoding="utf-8").splitlines() if file.exists() else []


def is_executed(process):
    """Neither gone nor a zombie: not everybody's process 1 buries those."""
    try:
        return pathlib.Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


class MachinePauses(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="knee_pauses_")  # pylint: disable=consider-using-with
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.pauses = self.folder / "pauses.txt"

    def watchers(self):
        """The witness, and its process on every processor once they are there."""
        witness = subprocess.Popen([SCRIPTS / "machine_pauses", self.pauses])  # pylint: disable=consider-using-with
        self.addCleanup(witness.wait)
        self.addCleanup(witness.kill)
        wanted, end = len(os.sched_getaffinity(0)), time.monotonic() + 30
        while True:
            children = pathlib.Path(f"/proc/{witness.pid}/task/{witness.pid}/children").read_text(encoding="utf-8").split()
            if len(children) == wanted or time.monotonic() > end:
                self.assertEqual(wanted, len(children))
                return witness, [int(child) for child in children]
            time.sleep(0.05)

    def test_a_processor_that_executes_nothing_for_a_while_is_written_down(self):
        _, children = self.watchers()
        for child in children:
            time.sleep(0.5)  # it watches by now
            os.kill(child, signal.SIGSTOP)
            time.sleep(0.2)
            os.kill(child, signal.SIGCONT)
        time.sleep(0.5)
        seen = [list(map(float, line.split())) for line in lines_of(self.pauses)]
        for processor in os.sched_getaffinity(0):
            lengths = [length for _, length, of in seen if of == processor]
            self.assertGreater(max(lengths, default=0.0), 150.0, f"processor {processor}")
        self.assertLess(abs(seen[-1][0] - time.time()), 60.0)

    def test_the_watchers_end_with_the_witness(self):
        witness, children = self.watchers()
        witness.kill()
        witness.wait()
        end = time.monotonic() + 30
        while any(map(is_executed, children)) and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual([], list(filter(is_executed, children)))

    def test_only_pauses_between_a_tests_begin_and_end_count_for_it(self):
        now = time.time()
        self.pauses.write_text("".join(f"{now - before:.3f} 100 1\n" for before in (25.0, 15.0, 5.0)), encoding="utf-8")
        results = self.folder / "knee_robot"
        results.mkdir()
        name = "_ctest_knee_robot_rostest_test_nodes_{}.test"
        cases = ""
        for test, status, ended, seconds in (("play", "fail", 10.0, 20.0), ("action", "fail", 0.0, 2.0), ("guiding", "run", 0.0, 60.0)):
            result = results / f"rostest-test_nodes_{test}.xml"
            result.write_text("", encoding="utf-8")
            os.utime(result, (now - ended, now - ended))
            cases += f'<testcase name="{name.format(test)}" time="{seconds}" status="{status}"/>'
        cases += f'<testcase name="{name.format("crashed")}" time="60" status="fail"/>'
        junit = self.folder / "attempt.xml"
        junit.write_text(f"<testsuite>{cases}</testsuite>", encoding="utf-8")
        said = subprocess.run([SCRIPTS / "failed_while_paused", self.pauses, junit, self.folder], capture_output=True, text=True, check=True)
        self.assertEqual("2 play\n0 action\n0 crashed\n", said.stdout)


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "machine_pauses", MachinePauses, sys.argv)
