"""The page stands alone, shows what was found, and believes nothing that it is given."""
import re
import shutil
import subprocess

import pandas as pd
import pytest

from changes_test import OPTIONS, add, fleet
from fleet import changes, page


def make(tmp_path, hostile=False):
    table = add(fleet(5), "r3", "friction", 2, 13, 0.3)
    residual = fleet(6, names=("residual",), spread=0.05)
    residual["value"] += 2.0
    table = pd.concat([table, residual], ignore_index=True)
    sessions = table[["robot", "day", "session"]].drop_duplicates().assign(state="done", sentence="", effects="")
    if hostile:
        sessions.loc[sessions.index[3], ["state", "sentence"]] = ["failed", "</script><script>document.title = 'broken'</script>"]
    return page.write_page(tmp_path, table, sessions, changes.find_changes(table, OPTIONS), changes.population(table), OPTIONS)


def test_the_page_needs_nothing_else(tmp_path):
    text = make(tmp_path).read_text()
    assert not re.findall(r"""(?:src|href)\s*=\s*["'](?:https?:)?//""", text) and "@import" not in text and "http://www.w3.org/2000/svg" in text


def browsed(path):
    chromium = shutil.which("chromium")
    if not chromium:
        pytest.skip("chromium is not installed")
    done = subprocess.run([chromium, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=3000", "--dump-dom", path.as_uri()],
                          capture_output=True, text=True, timeout=120, check=False)
    return done.stdout


def test_a_browser_shows_the_robot_that_changed_its_leg_and_its_trends(tmp_path):
    dom = browsed(make(tmp_path))
    changed = dom[dom.index('id="changes"'):dom.index('id="map"')]
    assert "r3" in changed and "friction, leg 2" in changed and re.search(r"\+\d\d %", changed)
    assert dom.count("<svg") == 8  # four legs, two quantities


def test_a_sentence_from_a_recording_is_text_and_no_program(tmp_path):
    dom = browsed(make(tmp_path, hostile=True))
    assert "<title>Fleet</title>" in dom and "&lt;/script&gt;&lt;script&gt;document.title" in dom
