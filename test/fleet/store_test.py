"""What is kept appears whole or not at all."""
import json
import os
import subprocess

import pytest

pytest.importorskip("pyarrow", reason="pyarrow could not be installed: scripts/fleet says why")

from fleet.store import SESSION_COLUMNS, Busy, Store  # noqa: E402
from fleet.store_file import write_whole  # noqa: E402


def entry(store, session, value, key):
    row = dict.fromkeys(SESSION_COLUMNS, "")
    row.update(robot="a", day="2026-01-05", session=session, key=key, state="done", final=True, traced=False, processor_s=0.1, seconds=0.1, peak_bytes=0)
    quantity = {"robot": "a", "day": "2026-01-05", "session": session, "kind": "A", "movement": "m", "quantity": "friction", "leg": 1, "value": value,
                "low": value - 1, "high": value + 1, "std": 0.5, "unit": "1"}
    write_whole(store.journal_file(key), json.dumps({"session": row, "quantities": [quantity]}))


@pytest.fixture
def store(tmp_path):
    made = Store(tmp_path / "store")
    made.lead()
    yield made
    made.release()


def test_the_journal_is_folded_once_and_then_gone(store):
    entry(store, "s1", 1.0, "k1")
    entry(store, "s2", 2.0, "k2")
    assert store.fold() == 2 and store.fold() == 0
    assert sorted(store.table("quantities")["value"]) == [1.0, 2.0]


def test_a_session_that_is_done_again_replaces_itself(store):
    entry(store, "s1", 1.0, "k1")
    store.fold()
    entry(store, "s1", 5.0, "k2")
    store.fold()
    assert list(store.table("quantities")["value"]) == [5.0] and list(store.table("sessions")["key"]) == ["k2"]


def test_a_fold_that_was_interrupted_after_its_tables_repeats_without_doubling(store):
    entry(store, "s1", 1.0, "k1")
    text = store.journal_file("k1").read_text()
    store.fold()
    store.journal_file("k1").write_text(text)
    store.fold()
    assert len(store.table("quantities")) == 1


def test_only_one_run_leads_a_folder(store):
    with pytest.raises(Busy, match="another run writes there"):
        Store(store.folder).lead()


def test_a_full_disk_leaves_what_was_there(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], capture_output=True, check=False).returncode:
        pytest.skip("a small file system cannot be mounted here")
    try:
        write_whole(disk / "result.json", "old")
        with pytest.raises(OSError, match="No space left"):
            write_whole(disk / "result.json", "x" * 200_000)
        assert (disk / "result.json").read_text() == "old" and os.listdir(disk) == ["result.json"]
    finally:
        subprocess.run(["umount", disk], check=True)
