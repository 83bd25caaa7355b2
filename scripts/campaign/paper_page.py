#!/usr/bin/python3
"""Tables of scripts/paper_evaluation beside the paper's figures, in Markdown on the terminal and as one HTML page.

Usage: paper_page.py FOLDER ROBOT        (FOLDER as scripts/paper_evaluation leaves it)"""
import base64
import html
import json
import math
import pathlib
import re
import sys

MOVEMENTS = ("paper_test", "hip_flexion", "knee_flexion", "knee_rotation", "ankle_flexion")
CAUSES = {"all": "all causes", "noise_and_frame": "noise and frame alone", "play": "with play in the joints",
          "lengths_at_home": "with wrong lengths at home"}
COORDINATES = (("x", "Xm mm", 1e3), ("z", "Zm mm", 1e3), ("theta", "theta deg", 180.0 / math.pi), ("psi", "psi deg", 180.0 / math.pi))
PAPER_ACTUATORS = ("1", "1", "1", "2")     # mm, Fig. 15
PAPER_POSE = ("30", "10", "2.5", "7")      # Fig. 16


def largest(figures, factor):
    """The largest error of one entry of compare's report, in the table's unit; '-' where there is none."""
    values = [v for k, v in figures.items() if k.startswith("max_") and v is not None]
    return f"{factor * values[0]:.2f}" if values else "-"


class Page:
    """Titles, sentences and tables, to the terminal at once and to the page at the end."""

    def __init__(self):
        self.parts = []

    def title(self, text):
        print(f"\n## {text}\n")
        self.parts.append(f"<h2>{html.escape(text)}</h2>")

    def say(self, text):
        print(text + "\n")
        self.parts.append(f"<p>{html.escape(text)}</p>")

    def table(self, head, rows):
        print("| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
        for row in rows:
            print("| " + " | ".join(row) + " |")
        cells = ["<tr>" + "".join(f"<th>{html.escape(c)}</th>" for c in head) + "</tr>"]
        cells += ["<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in row) + "</tr>" for row in rows]
        self.parts.append("<table>" + "".join(cells) + "</table>")

    def text(self, content):
        print(content)
        self.parts.append(f"<pre>{html.escape(content)}</pre>")

    def picture(self, path):
        data = base64.b64encode(path.read_bytes()).decode()
        self.parts.append(f'<img alt="{html.escape(path.stem)}" src="data:image/svg+xml;base64,{data}">')

    def write(self, path):
        style = ("body{font:16px/1.5 sans-serif;max-width:72em;margin:2em auto;padding:0 1em}table{border-collapse:collapse}"
                 "td,th{border:1px solid #bbb;padding:.2em .6em;text-align:right}td:first-child,th:first-child{text-align:left}"
                 "img{max-width:100%;height:auto}pre{overflow-x:auto;background:#f6f6f6;padding:1em;font-size:12px}")
        path.write_text("<!DOCTYPE html><html lang=en><meta charset=utf-8><title>The paper's evaluation</title><style>" + style +
                        "</style><body><h1>The paper's evaluation, redone</h1>" + "\n".join(self.parts) + "</body></html>\n", encoding="utf-8")


def report(folder, movement, cause):
    return json.loads((folder / "compared" / f"{movement}.{cause}" / "report.json").read_text(encoding="utf-8"))


def movements(page, folder, robot):
    reports = {m: report(folder, m, "all") for m in MOVEMENTS}
    page.title("Fig. 15: reference against measured, largest error, mm")
    page.say(f"Robot {robot}, the controller in real time on the simulated robot. The paper shows its test movement only.")
    page.table(("movement", "leg 1", "leg 2", "leg 3", "leg 4"),
               [(m, *(largest(a, 1e3) for a in r["actuators"])) for m, r in reports.items()] + [("paper", *PAPER_ACTUATORS)])
    page.title("Fig. 16: pose seen by the camera against the reference, largest error")
    page.table(("movement", *(name for _, name, _ in COORDINATES)),
               [(m, *(largest(r["camera"]["camera_minus_reference"][k], f) for k, _, f in COORDINATES)) for m, r in reports.items()]
               + [("paper", *PAPER_POSE)])
    page.say("What explains it: the same movement with the camera's other imperfections taken away, and what the encoders say (the loops' own error).")
    rows = []
    for cause, words in CAUSES.items():
        r = report(folder, "paper_test", cause)
        rows.append((words, *(largest(r["camera"]["camera_minus_reference"][k], f) for k, _, f in COORDINATES)))
    rows.append(("encoders (no camera)", *(largest(reports["paper_test"]["pose"][k], f) for k, _, f in COORDINATES)))
    page.table(("paper_test seen with", *(name for _, name, _ in COORDINATES)), rows)
    for name in ("actuators.svg", "pose.svg"):
        page.picture(folder / "compared" / "paper_test.all" / name)
    for m, r in reports.items():
        for note in r["notes"]:
            page.say(f"{m}: {note}")


def harmonics(page, folder):
    page.title("Figs. 4 and 5: number of harmonics, 20 s at 0.01 m/s")
    page.say("The paper takes 7: with fewer the curves are pure sines, with more the optimisation gets harder; it asks for k < 300.")
    rows = []
    files = sorted((folder / "harmonics").glob("*.report"), key=lambda path: int(path.stem))
    for file in files:
        words = file.read_text(encoding="utf-8")
        scaled = {int(m[0]): m[1] for m in re.findall(r"^\s+(\d+)\s+([\d.e+]+)\s+[\d.e+]+\s+[\d.e+]+", words, flags=re.M)}
        seconds = re.search(r"^([\d.]+) s, ", words, flags=re.M)
        rows.append((file.stem, *(scaled.get(r, "no plan") for r in (30, 51, 56)), seconds[1] if seconds else "-"))
    page.table(("harmonics", "k at r = 30", "k at r = 51", "k at r = 56", "s"), rows)


def main():
    folder, robot = pathlib.Path(sys.argv[1]), sys.argv[2]
    page = Page()
    movements(page, folder, robot)
    if (folder / "harmonics").is_dir():
        harmonics(page, folder)
    for name, title in (("findings", "Tables 1 and 2: geometry, parameters (scripts/paper_findings)"),
                        ("compatibility", "Tables 3 and 4: compatibility with the virtual plant (scripts/compatibility)")):
        file = folder / f"{name}.txt"
        if file.is_file():
            page.title(title)
            page.text(file.read_text(encoding="utf-8"))
    page.write(folder / "paper.html")


if __name__ == "__main__":
    main()
