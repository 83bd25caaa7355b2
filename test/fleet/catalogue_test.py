"""Which robot recorded what on which day, and what is refused."""
import datetime

import pandas as pd
import pytest

from fleet.catalogue import CatalogueError, day_in, read_catalogue


def touch(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("")
    return path


@pytest.mark.parametrize("name", ["robot_2026-02-03", "B_N_03_02_2026_161533", "20260203_run1"])
def test_the_day_is_read_from_a_file_name(name):
    assert day_in(name) == datetime.date(2026, 2, 3)


@pytest.mark.parametrize("name", ["run1", "2026-13-40", "12345678901"])
def test_a_name_without_a_day_has_none(name):
    assert day_in(name) is None


def test_a_folder_of_robots_is_a_catalogue(tmp_path):
    for robot in ("b", "a"):
        touch(tmp_path / robot / "robot.yaml")
        touch(tmp_path / robot / "run_2026-01-06.csv")
        touch(tmp_path / robot / "run_2026-01-05.csv")
    assert [(s.robot, s.day.day) for s in read_catalogue(tmp_path)] == [("a", 5), ("a", 6), ("b", 5), ("b", 6)]


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_table_is_a_catalogue_and_its_paths_are_relative_to_it(tmp_path, suffix):
    if suffix == "parquet":
        pytest.importorskip("pyarrow")
    touch(tmp_path / "A.yaml")
    rows = pd.DataFrame([["a", "2026-01-05", "x/run.csv", "A.yaml"]], columns=["robot", "day", "recording", "robot_file"])
    path = tmp_path / f"catalogue.{suffix}"
    rows.to_csv(path, index=False) if suffix == "csv" else rows.to_parquet(path)
    assert read_catalogue(path)[0].recording == str(tmp_path / "x" / "run.csv")


@pytest.mark.parametrize("row, sentence", [("a,yesterday,r.csv,A.yaml", ":2: day 'yesterday' is no date"), ("../a,2026-01-05,r.csv,A.yaml", ":2: robot name"),
                                           ("a,2026-01-05,r.csv,B.yaml", ":2: robot file")])
def test_a_bad_row_is_refused_by_its_line(tmp_path, row, sentence):
    touch(tmp_path / "A.yaml")
    path = tmp_path / "catalogue.csv"
    path.write_text("robot,day,recording,robot_file\n" + row + "\n")
    with pytest.raises(CatalogueError, match=sentence):
        read_catalogue(path)


def test_a_missing_column_is_named(tmp_path):
    path = tmp_path / "catalogue.csv"
    path.write_text("robot,date\na,2026-01-05\n")
    with pytest.raises(CatalogueError, match="has no column day, recording, robot_file"):
        read_catalogue(path)


def test_an_empty_folder_and_an_absent_one_are_refused(tmp_path):
    with pytest.raises(CatalogueError, match="holds no recording"):
        read_catalogue(tmp_path)
    with pytest.raises(CatalogueError, match="no such folder"):
        read_catalogue(tmp_path / "nowhere")


def test_two_recordings_of_one_name_on_one_day_are_refused(tmp_path):
    touch(tmp_path / "A.yaml")
    path = tmp_path / "catalogue.csv"
    path.write_text("robot,day,recording,robot_file\na,2026-01-05,x/r.csv,A.yaml\na,2026-01-05,y/r.csv,A.yaml\n")
    with pytest.raises(CatalogueError, match="rename one"):
        read_catalogue(path)
