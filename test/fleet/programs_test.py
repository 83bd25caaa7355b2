"""A program's end is a result, whatever it was."""
import time

from fleet.programs import Limits, run


def test_a_program_that_is_done_says_so_and_keeps_its_output():
    outcome = run(["echo", "done"])
    assert outcome.done and outcome.output == "done\n" and outcome.sentence == ""


def test_the_last_line_of_a_complaint_is_the_sentence():
    outcome = run(["bash", "-c", "echo reading; echo 'file.csv:3: no number' >&2; exit 2"])
    assert outcome.status == 2 and outcome.sentence == "bash: file.csv:3: no number"


def test_a_crash_is_named_by_its_signal():
    assert run(["bash", "-c", "kill -SEGV $$"]).sentence == "bash was ended by SIGSEGV"


def test_a_program_that_hangs_is_ended_with_its_children(tmp_path):
    mark = tmp_path / "alive"
    outcome = run(["bash", "-c", f"(sleep 2; touch {mark}) & sleep 60"], Limits(seconds=0.5))
    assert outcome.status is None and "time limit of 0.5 s" in outcome.sentence
    time.sleep(2.5)
    assert not mark.exists()


def test_hunger_for_memory_ends_at_the_limit():
    outcome = run(["/usr/bin/python3", "-c", "x = bytearray(900_000_000)"], Limits(memory_bytes=500_000_000))
    assert outcome.status == 1 and "MemoryError" in outcome.sentence


def test_a_program_that_is_not_there_is_a_sentence():
    assert "no such program; run scripts/build" in run(["/nowhere/identify"]).sentence
