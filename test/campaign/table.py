"""The campaign's result as a Markdown table with the targets beside."""
import re
import statistics

from faults import DISABLED, DOWN, GOES_ON, all_faults

DEATH_MS, DROP_MM = 20.0, 5.0


def median_and_largest(values, digits=0):
    values = [v for v in values if v is not None]
    if not values:
        return "never"
    return f"{statistics.median(values):.{digits}f} / {max(values):.{digits}f}"


def without_folders(sentence):
    """Paths shortened to the file's name: the table is for other machines too."""
    return re.sub(r"/\S*/", "", sentence)


def quantile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


def is_held(run):
    """By the brakes, or, where one of them slips, by the drives."""
    return run["held_ms"] is not None or run.get("carried", False)


def verdict(fault, runs):
    """What is wrong with the runs of one fault; empty: nothing."""
    found = []

    def note(sentence, share):
        if share:
            found.append(sentence if share == len(runs) else f"{sentence} ({share} of {len(runs)})")

    note("cause", sum(not r["cause_right"] for r in runs))
    note("recording", sum(bool(r["recording"]) for r in runs if not fault.name.startswith("disk_full")))
    note("above clamp", sum(r["above_clamp_V"] > 0.0 for r in runs))
    note("beyond limits", sum(r["beyond_limits_mm"] > 0.0 for r in runs))
    if fault.outcome != GOES_ON:
        note("drop", sum(r["drop_mm"] > DROP_MM for r in runs))
        note("not held", sum(not is_held(r) for r in runs))
    if fault.process_death:
        note("later than 20 ms", sum(r["stop_begins_ms"] is None or r["stop_begins_ms"] > DEATH_MS for r in runs))
    note("other", sum(bool(r["wrong"]) for r in runs))
    return found


def line(fault, runs):
    stops = fault.outcome != GOES_ON
    begins = median_and_largest([r["stop_begins_ms"] for r in runs], 1) if stops else "-"
    held = median_and_largest([r["held_ms"] for r in runs]) if stops else "-"
    reported = sorted({r["cause"] or "none" for r in runs})
    expected = fault.causes[0] if fault.causes else "none"
    if len(fault.causes) > 1:
        expected += " (or " + ", ".join(fault.causes[1:]) + ")"
    wrong = verdict(fault, runs)
    cells = [fault.name, str(len(runs)), begins, held, f"{max(r['drop_mm'] for r in runs):.2f}",
             f"{max(r.get('least_mm', 0.0) for r in runs):.2f}" if stops else "-",
             f"{max(r['beyond_limits_mm'] for r in runs):.1f}", f"{max(r['above_clamp_V'] for r in runs):.2f}",
             ", ".join(sorted({r["state"] for r in runs})), ", ".join(reported),
             expected,
             "intact" if not any(r["recording"] for r in runs) else "see below", "good" if not wrong else "**" + "; ".join(wrong) + "**"]
    return "| " + " | ".join(cells) + " |"


def named_itself(fault, run):
    """The first of the causes is the fault's own name; the others are true descriptions of what it led to."""
    return not fault.causes or run["cause"] == fault.causes[0] or fault.outcome == DOWN


def summary(results, faults):
    """The issue's targets over all runs."""
    by_name = {f.name: f for f in faults}
    runs = [r for r in results if r["fault"] in by_name]
    deaths = [r["stop_begins_ms"] for r in runs if by_name[r["fault"]].process_death]
    deaths_known = [d for d in deaths if d is not None]
    stops = [r for r in runs if by_name[r["fault"]].outcome != GOES_ON]
    left = [r for r in stops if by_name[r["fault"]].brakes_can_be_ordered]
    disk = [r for r in runs if not r["fault"].startswith("disk_full")]
    lines = ["| target | result |", "| --- | --- |",
             f"| no output above its clamp, ever | {sum(r['above_clamp_V'] > 0 for r in runs)} of {len(runs)} runs above |",
             f"| no axis beyond its limits | {sum(r['beyond_limits_mm'] > 0 for r in runs)} of {len(runs)} runs beyond |"]
    if deaths_known:
        lines.append(f"| stop begun within 20 ms of a process death (95 %) | 95 %: {quantile(deaths_known, 0.95):.1f} ms, "
                     f"median {statistics.median(deaths_known):.1f} ms, largest {max(deaths_known):.1f} ms of {len(deaths)} |")
    if stops:
        lines.append(f"| drop below 5 mm | {sum(r['drop_mm'] > DROP_MM for r in stops)} of {len(stops)} above; "
                     f"where somebody is left who can order the brakes, {sum(r['drop_mm'] > DROP_MM for r in left)} of {len(left)}, "
                     f"largest {max((r['drop_mm'] for r in left), default=0.0):.2f} mm; "
                     f"5 mm more than brakes ordered in the moment of the fault would leave: "
                     f"{sum(r['drop_mm'] > DROP_MM + max(0.0, r.get('least_mm', 0.0)) for r in left)} |")
    lines += [f"| cause named correctly in all | {sum(r['cause_right'] for r in runs)} of {len(runs)}; "
              f"by its own name, not only by what it led to, {sum(r['cause_right'] and named_itself(by_name[r['fault']], r) for r in runs)} |",
              f"| sinking when the brakes open (no target) | largest {max((r['enable_sag_mm'] for r in runs), default=0.0):.2f} mm |",
              f"| axes held in the end, or carried where a brake slips | {sum(is_held(r) for r in stops)} of {len(stops)}; "
              f"where somebody is left who can order the brakes, {sum(is_held(r) for r in left)} of {len(left)} |",
              f"| recording intact | {sum(not r['recording'] for r in disk)} of {len(disk)} |"]
    return lines


def render(results, conditions):
    faults = all_faults()
    done = [f for f in faults if any(r["fault"] == f.name for r in results)]
    text = [f"{len(done)} faults, {len([r for r in results if r['fault'] in {f.name for f in done}])} runs. {conditions}", "",
            *summary(results, done), "",
            "Times in ms: median / largest. Stop begins: brakes ordered to engage, or the reference slows down along its path, whichever "
            "is first. Held: every axis braked and unpowered. Drop and excesses: largest of all runs. Of that least: fallen before brakes that "
            "are ordered in the very moment of the fault would hold.", "",
            "| fault | runs | stop begins | held | drop mm | of that least mm | beyond limits mm | above clamp V | state | cause reported | cause expected "
            "| recording | verdict |",
            "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"]
    remarks = []
    for fault in done:
        runs = [r for r in results if r["fault"] == fault.name]
        text.append(line(fault, runs))
        for what in sorted({r["recording"] for r in runs} | {r["wrong"] for r in runs}):
            if what:
                remarks.append(f"- `{fault.name}`: {without_folders(what)[:300]}")
        for r in runs:
            if not r["cause_right"] and r["sentence"]:
                remarks.append(f"- `{fault.name}`: said \"{r['sentence']}\"")
                break
    if remarks:
        text += ["", "Remarks:", "", *dict.fromkeys(remarks)]
    return "\n".join(text) + "\n"


__all__ = ["render", "DISABLED"]
