"""A night's run on simulated recordings and the real programs: done once, and what fails costs itself only."""
import os
import shutil
import subprocess

import pandas as pd
import pytest

pytest.importorskip("pyarrow", reason="pyarrow could not be installed: scripts/fleet says why")

from fleet import nightly  # noqa: E402
from fleet.catalogue import read_catalogue  # noqa: E402
from fleet.store import Store  # noqa: E402


@pytest.fixture
def folder(recordings, tmp_path):
    """A copy that may be spoilt."""
    shutil.copytree(recordings, tmp_path / "fleet")
    return tmp_path / "fleet"


def night(folder, output, engine, programs, **options):
    store = Store(output)
    store.lead()
    try:
        summary = nightly.Night(store, engine, nightly.Options(programs, **{"trace": "never", **options})).run(read_catalogue(folder))
        return summary, store
    finally:
        store.release()


def own_recordings(folder):
    return sorted(folder.glob("*/*.csv"))


def test_a_second_run_does_nothing_and_a_new_recording_is_all_that_is_done(folder, tmp_path, engine, programs):
    held_back = own_recordings(folder)[-1]
    later = tmp_path / held_back.name
    held_back.rename(later)
    first, _ = night(folder, tmp_path / "out", engine, programs)
    assert (first.done, first.kept, first.failures) == (3, 0, [])
    again, _ = night(folder, tmp_path / "out", engine, programs)
    assert (again.done, again.kept) == (0, 3)
    later.rename(held_back)
    third, store = night(folder, tmp_path / "out", engine, programs)
    assert (third.done, third.kept) == (1, 3)
    assert len(store.table("sessions")) == 4


def test_friction_that_grew_is_seen_in_its_leg_and_no_other(folder, tmp_path, engine, programs):
    _, store = night(folder, tmp_path / "out", engine, programs)
    friction = store.table("quantities").query("quantity == 'friction'").pivot(index="leg", columns="day", values="value")
    change = friction[friction.columns[-1]] - friction[friction.columns[:-1]].mean(axis=1)
    assert change[2] == pytest.approx(0.25, abs=0.08)
    assert change.drop(2).abs().max() < 0.1


def test_spoilt_recordings_cost_themselves_and_are_listed_with_their_sentence(folder, tmp_path, engine, programs):
    files = own_recordings(folder)
    files[1].write_bytes(files[1].read_bytes()[: 20_000] + b"0.1,0.2")  # ends inside a row
    (files[0].parent / "robot-7001_2026-03-30.csv").write_text("")
    summary, store = night(folder, tmp_path / "out", engine, programs)
    assert summary.done == 3 and len(summary.failures) == 2
    assert all(sentence for _, _, sentence in summary.failures)
    assert set(store.table("sessions").query("state == 'failed'")["day"]) == {files[1].stem[-10:], "2026-03-30"}
    again, _ = night(folder, tmp_path / "out", engine, programs)
    assert (again.done, again.kept, again.failures) == (0, 5, []), "what cannot be read is not tried again while it is the same"


def test_a_first_day_that_makes_no_model_leaves_that_to_the_next(folder, tmp_path, engine, programs):
    files = own_recordings(folder)
    files[0].write_text(files[0].read_text()[:3000])
    summary, store = night(folder, tmp_path / "out", engine, programs)
    assert summary.done == 3 and [f[1] for f in summary.failures] == [f"{files[0].stem[-10:]}_{files[0].stem}"]
    assert files[1].stem in (store.robot("robot-7001") / "baseline" / "baseline.json").read_text()


def test_a_program_that_crashes_or_hangs_is_a_result_and_is_tried_again(folder, tmp_path, engine, programs):
    bad = tmp_path / "programs"
    bad.mkdir()
    for name in ("identify", "trace"):
        (bad / name).symlink_to(programs / name)
    marked = own_recordings(folder)[2].name
    (bad / "predict").write_text(f'#!/bin/bash\n[[ "$*" == *{marked}* && -e {tmp_path}/sick ]] && kill -SEGV $$\nexec {programs}/predict "$@"\n')
    (bad / "predict").chmod(0o755)
    (tmp_path / "sick").touch()
    summary, _ = night(folder, tmp_path / "out", engine, bad)
    assert summary.done == 3 and summary.failures[0][2] == "predict was ended by SIGSEGV"
    (tmp_path / "sick").unlink()
    summary, _ = night(folder, tmp_path / "out", engine, bad)
    assert (summary.done, summary.kept, summary.failures) == (1, 3, [])


def test_a_changed_program_or_recording_is_work_again(folder, tmp_path, engine, programs):
    night(folder, tmp_path / "out", engine, programs)
    files = own_recordings(folder)
    rows = files[2].read_text().splitlines()
    files[2].write_text("\n".join(rows[:-5]) + "\n")
    summary, store = night(folder, tmp_path / "out", engine, programs)
    assert (summary.done, summary.kept) == (1, 3)
    other = tmp_path / "programs"
    other.mkdir()
    for name in ("identify", "trace"):
        (other / name).symlink_to(programs / name)
    (other / "predict").write_text(f'#!/bin/bash\n# another version\nexec {programs}/predict "$@"\n')
    (other / "predict").chmod(0o755)
    summary, store = night(folder, tmp_path / "out", engine, other)
    assert (summary.done, summary.kept) == (4, 0)
    assert len(store.table("sessions")) == 4 and not store.table("quantities").duplicated(["robot", "session", "quantity", "leg"]).any()


def test_a_full_disk_is_said_and_what_is_lacking_is_done_when_there_is_room(folder, tmp_path, engine, programs):
    disk = tmp_path / "disk"
    disk.mkdir()
    if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", disk], capture_output=True, check=False).returncode:
        pytest.skip("a small file system cannot be mounted here")
    try:
        night(folder, disk / "out", engine, programs)  # the first day's model fits
        late = own_recordings(folder)[-1]
        text = late.read_text()
        late.write_text(text[: text.rfind("\n", 0, -1) + 1])  # one row less: to be done again
        space = os.statvfs(disk)
        (disk / "ballast").write_bytes(b"x" * (space.f_bavail * space.f_frsize))
        summary, _ = night(folder, disk / "out", engine, programs)
        assert len(summary.failures) == 1 and "No space left" in summary.failures[0][2] and summary.kept == 3
        (disk / "ballast").unlink()
        summary, store = night(folder, disk / "out", engine, programs)
        assert (summary.done, summary.kept, summary.failures) == (1, 3, [])
        assert len(store.table("sessions")) == 4
    finally:
        subprocess.run(["umount", disk], check=True)


def test_every_later_day_is_traced_and_its_report_kept_beside(folder, tmp_path, engine, programs):
    for extra in own_recordings(folder)[2:]:
        extra.unlink()
    summary, store = night(folder, tmp_path / "out", engine, programs, trace="every")
    assert summary.done == 2 and not summary.failures
    assert len(list((tmp_path / "out").glob("robots/*/*/report.html"))) == 3  # the first day's model, and two days traced
    assert isinstance(store.table("sessions"), pd.DataFrame) and store.table("sessions")["effects"].str.startswith("[").all()
