#!/usr/bin/python3
"""Tables of scripts/paper_evaluation beside the paper's figures, in Markdown on the terminal and as one HTML page.

Usage: paper_page.py FOLDER ROBOT        (FOLDER as scripts/paper_evaluation leaves it)"""
import base64
import datetime
import html
import os
import pathlib
import sys

import paper_tables as tables

STYLE = """body{font:16px/1.5 sans-serif;max-width:72em;margin:2em auto;padding:0 1em;color:#222}
.wide{overflow-x:auto}table{border-collapse:collapse;margin:.8em 0}td,th{border:1px solid #ccc;padding:.2em .6em;text-align:right}
td:first-child,th:first-child{text-align:left}th{background:#f2f2f2}tr.paper td{background:#f2f6fb}
.missed{color:#a02020;font-weight:600}.met{color:#1d6b34}.differs{color:#8a5a00;font-weight:600}
img{max-width:100%;height:auto}.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(26em,1fr));gap:1em}
summary{cursor:pointer;color:#1f5fa8}pre{overflow-x:auto;background:#f6f6f6;padding:1em;font-size:12px}
@media(max-width:40em){.pair{display:block}}"""
ORDER = ("missed", "differs", "met")


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

    def table(self, content):
        head, rows = content
        print("| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
        cells = ["<tr>" + "".join(f"<th>{html.escape(c)}</th>" for c in head) + "</tr>"]
        for row in rows:
            print("| " + " | ".join(row) + " |")
            of = ' class="paper"' if row[0].startswith("paper") and row[0] != "paper_test" else ""
            marks = [f' class="{c}"' if c in ORDER else "" for c in row]
            cells.append(f"<tr{of}>" + "".join(f"<td{m}>{html.escape(c)}</td>" for m, c in zip(marks, row)) + "</tr>")
        print()
        self.parts.append('<div class="wide"><table>' + "".join(cells) + "</table></div>")

    def folded(self, title, inside):
        self.parts.append(f"<details><summary>{html.escape(title)}</summary>{inside}</details>")

    def pictures(self, *pictures):
        self.parts.append('<div class="pair">' + "".join(f"<div>{p}</div>" for p in pictures if p) + "</div>")

    def write(self, path):
        path.write_text('<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
                        f"<title>The paper's evaluation</title><style>{STYLE}</style></head><body>"
                        "<h1>The paper's evaluation, redone</h1>" + "\n".join(self.parts) + "</body></html>\n", encoding="utf-8")


def embedded(path):
    data = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{html.escape(path.parent.name)} {html.escape(path.stem)}" src="data:image/svg+xml;base64,{data}">'


def curves(page, folder, name):
    """A picture of compare for the paper's own movement; those of the others behind a click."""
    page.parts.append(embedded(folder / "compared" / "paper_test.all" / name))
    for movement in tables.MOVEMENTS[1:]:
        page.folded(f"the same for {movement}", embedded(folder / "compared" / f"{movement}.all" / name))


def words_of(page, folder, name, title):
    file = folder / f"{name}.txt"
    if file.is_file():
        page.folded(title, f"<pre>{html.escape(file.read_text(encoding='utf-8').strip())}</pre>")


def main():
    folder, robot = pathlib.Path(sys.argv[1]), sys.argv[2]
    page = Page()
    (table_1, c1), (table_2, c2), (study, c3), (errors, c4) = tables.geometry(), tables.parameters(folder), tables.harmonics(folder), tables.forces(folder)
    (legs, c5), (poses, why, c6) = tables.actuators(folder), tables.poses(folder)
    # What was played is there; tables that were left out (--movements-only) leave no line.
    comparisons = sorted((c1 if table_2 else []) + c2 + c3 + c4 + tables.amplitudes(folder) + c5 + c6, key=lambda row: ORDER.index(row[3]))
    page.title("In short")
    page.say(f"{datetime.date.today().isoformat()}, {os.cpu_count()} processors. Missed: worse than the paper, or than what it asks for. Everything here is simulated: "
             "the paper's robot carried its own play, misalignment and cameras, this one those of config/simulation.")
    page.table((("figure or table", "paper", "here", ""), comparisons))
    if table_2:
        page.title("Table 1: geometries")
        page.table(table_1)
        page.title("Table 2: parameters without effect, and base parameters")
        page.table(table_2)
        page.say("Without effect in Table 2: " + " ".join(tables.WITHOUT_EFFECT) + ".")
        page.say("For rich motion 51 rigid combinations change the forces. The paper's 34 are what its slow, smooth trajectories support.")
        words_of(page, folder, "findings", "all that scripts/paper_findings says")
    if study:
        page.title("Figs. 4 and 5: number of harmonics, 20 s at 0.01 m/s")
        page.say("The paper takes 7: with fewer the curves are pure sines, with more the optimisation gets harder; it asks for k < 300 without saying at how "
                 "many directions r. Seed 1, at most 30 s of planning each, final geometry.")
        page.table(study)
        home = folder / "harmonics"
        page.pictures(tables.reference_picture("Fig. 4 (a): 2 harmonics", home / "2.txt"), tables.reference_picture("Fig. 4 (b): 14 harmonics", home / "14.txt"),
                      tables.reference_picture("Fig. 5 (a): identification", folder / "compatibility" / "final" / "identification.txt"),
                      tables.reference_picture("Fig. 5 (b): verification, q23 = q33", folder / "compatibility" / "final" / "verification.txt"))
    if errors:
        page.title("Tables 3 and 4: the model against a virtual plant")
        page.say("Simbody in place of Adams/View, Coulomb and viscous friction in the 11 joints of eq. (23), encoders of 5 um; all samples, low-passed at 3 Hz. "
                 "The paper's newtons belong to its own friction and masses: only the shares compare.")
        for title, table in errors:
            page.say(title)
            page.table(table)
        page.say("Fig. 13: what is left in the verification. The needles are single rows: where an actuator reverses, the recorded millisecond holds both "
                 "directions of its friction. Low-passed, as in the table, they hardly count.")
        page.pictures(tables.residual_picture(folder, "final"), tables.residual_picture(folder, "starting"))
        words_of(page, folder, "compatibility", "all plants, moving samples, unfiltered rows (scripts/compatibility)")
    page.title("Fig. 15: reference against measured")
    page.say(f"Robot {robot}, the controller in real time on the simulated robot. The paper shows its test movement only.")
    page.table(legs)
    curves(page, folder, "actuators.svg")
    page.title("Fig. 16: pose seen by the camera against the reference")
    page.table(poses)
    page.say("What explains it: the same movement seen by a camera with fewer imperfections, and by the encoders alone (the loops' own error).")
    page.table(why)
    curves(page, folder, "pose.svg")
    for movement in tables.MOVEMENTS:
        for note in tables.report(folder, movement, "all")["notes"]:
            page.say(f"{movement}: {note}")
    page.write(folder / "paper.html")


if __name__ == "__main__":
    main()
