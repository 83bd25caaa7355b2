"""Evaluates the results of the injection campaign and prints the tables."""
import math

from campaign import effects

WEIGHTS = ["-", "weak", "medium", "strong"]


def clopper_pearson_upper(hits, trials, level=0.95):
    """Upper bound of a rate: the one at which `hits` or fewer would be seen with probability 1 - level."""
    if trials == 0 or hits == trials:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(60):
        p = 0.5 * (low + high)
        tail = sum(math.comb(trials, k) * p**k * (1 - p) ** (trials - k) for k in range(hits + 1))
        low, high = (p, high) if tail > 1 - level else (low, p)
    return high


def here(effect, part):
    return part["actuator"] == 0 or part["actuator"] in effect["actuators"]


def verdicts(result):
    """exact, pair, wrong or none for every part of the truth; and the number of added effects that are none of them."""
    out, right = [], set()
    unlisted = result["kind"] == "unlisted"
    for part in result["truth"]:
        wanted = effects.CLASS_SINCE.get(part["name"], "unnamed") if unlisted else part["name"]
        best = "none"
        for k, e in enumerate(result["effects"]):
            if not here(e, part):
                continue
            if e["name"] == wanted:
                right.add(k)
                best = "exact" if not e["alternatives"] or best == "exact" else "pair"
            elif wanted in e["alternatives"]:
                right.add(k)
                best = "pair" if best != "exact" else best
        out.append(best)
    wrong = len(result["effects"]) - len(right)
    return ["wrong" if v == "none" and wrong else v for v in out], wrong


def gap(values, clean):
    return [math.sqrt(max(0.0, v * v - c * c)) for v, c in zip(values, clean)]


def worst(values):
    return max(range(len(values)), key=lambda k: values[k])


def above_floor(result, clean):
    """The effect's share of the baseline's training residual over the floor, where that is largest. The floor of an actuator is what the
    effect-free robot leaves, that is, what the true model would leave, or the one that trace reports for it (a hundredth of the
    actuator's force at least), whichever is larger."""
    floor = [max(left, stated) for left, stated in zip(clean["before_train"], clean["floor"])]
    return max(g / f for g, f in zip(gap(result["before_train"], clean["before_train"]), floor))


def material(result, clean):
    """The effect exceeds twice the floor. None without the effect-free record."""
    return None if clean is None else above_floor(result, clean) > 2


def share(part, whole):
    return f"{part} of {whole}" + (f" ({100 * part / whole:.0f} %)" if whole else "")


def found_text(result):
    return ", ".join(e["name"] + str(e["actuators"]).replace(" ", "") + ("~" + "/".join(e["alternatives"]) if e["alternatives"] else "")
                     for e in result["effects"]) or "-"


def truth_text(result):
    return "+".join(f"{t['name']}[{t['actuator']}]" if t["actuator"] else t["name"] for t in result["truth"]) or "clean"


def numbers(values):
    return "[" + " ".join(f"{v:.2f}" for v in values) + "]"


def line(result, clean=None):
    if "failed" in result:
        return f"{result['id']}: {result['failed']} failed"
    what = "/".join(verdicts(result)[0]) if result["truth"] else ("touched" if result["effects"] else "clean")
    size = f"{result['size_percent']:5.1f} %" if "size_percent" in result else "       "
    mark = {True: "M", False: "-", None: "?"}[material(result, clean)] if result["truth"] else " "
    return (f"{truth_text(result):34} {WEIGHTS[result['strength']]:6} {size} {mark} {what:11} {result['seconds']:5.1f} s {result['machine'].split(' P ')[0]:20} "
            f"training {numbers(result['before_train'])} -> {numbers(result['after_train'])} "
            f"other {numbers(result['before_validate'])} -> {numbers(result['after_validate'])} found {found_text(result)}")


def confusion(results):
    columns = sorted({e["name"] for r in results for e in r["effects"]})
    print("\nconfusion, records with one effect or none (rows: truth; columns: what was added)")
    print(f"{'':30}" + "".join(f"{c[:11]:>12}" for c in columns) + f"{'nothing':>12}{'records':>9}")
    rows = {}
    for r in results:
        if r["kind"] != "pair":
            rows.setdefault((r["kind"] == "unlisted", r["truth"][0]["name"] if r["truth"] else "clean"), []).append(r)
    for (_, name), group in sorted(rows.items()):
        counts = [sum(1 for r in group for e in r["effects"] if e["name"] == c) for c in columns]
        print(f"{name:30}" + "".join(f"{k or '.':>12}" for k in counts) + f"{sum(1 for r in group if not r['effects']) or '.':>12}{len(group):9}")


def detection(results, clean):
    kinds = ("exact", "pair", "wrong", "none")
    print(f"\n{'detection, single effects':30}" + "".join(f"{k:>8}" for k in kinds) + "   material only: exact, pair, wrong, none")
    for title, chosen in [("weak", lambda r: r["strength"] == 1), ("medium", lambda r: r["strength"] == 2), ("strong", lambda r: r["strength"] == 3),
                          ("size below 5 %", lambda r: r["size_percent"] < 5), ("size 5 to 12 %", lambda r: 5 <= r["size_percent"] < 12),
                          ("size above 12 %", lambda r: r["size_percent"] >= 12), ("simulated robot", lambda r: r["machine"].startswith("robot")),
                          ("Simbody plant", lambda r: r["machine"].startswith("simbody")), ("fast", lambda r: "0.1 m/s" in r["machine"]),
                          ("slow", lambda r: "0.05 m/s" in r["machine"]), ("all", lambda r: True)]:
        group = [r for r in results if r["kind"] == "single" and chosen(r)]
        named = [verdicts(r)[0][0] for r in group]
        big = [verdicts(r)[0][0] for r in group if material(r, clean.get(r["setting"]))]
        print(f"{title:30}" + "".join(f"{named.count(k):8}" for k in kinds) + "        " + "".join(f"{big.count(k):7}" for k in kinds))
    big = [verdicts(r)[0][0] for r in results if r["kind"] == "single" and material(r, clean.get(r["setting"]))]
    print(f"material single effects: exact or in a pair {share(big.count('exact') + big.count('pair'), len(big))}, exactly {share(big.count('exact'), len(big))}")
    parts = [v for r in results if r["kind"] == "pair" for v in verdicts(r)[0]]
    print(f"two effects at once: {share(parts.count('exact') + parts.count('pair'), len(parts))} of the parts named")


def sizes(results, clean):
    """What there was to find, kind by kind."""
    print("\nsingle effects over the floor (their share of the training residual, in floors; above 2: material)")
    kinds = {}
    for r in results:
        if r["kind"] in ("single", "unlisted") and r["setting"] in clean:
            kinds.setdefault(r["truth"][0]["name"], []).append((r["strength"], above_floor(r, clean[r["setting"]])))
    for name, found in sorted(kinds.items()):
        print(f"  {name:30}" + "  ".join(f"{WEIGHTS[s]} {v:.2f}" for s, v in sorted(found)))


def errors(results, clean):
    print("\nerror on the other path, actuator with the largest excess over the clean recording, N: before, after, effect-free,"
          " reachable by who knows the effect's force (but not a ripple's phase there)")
    within, removed, reached = [], [], []
    for r in sorted(results, key=lambda r: (r["kind"], truth_text(r), r["strength"])):
        if r["kind"] not in ("single", "unlisted"):
            continue
        same_clean = clean.get(r["setting"])
        best = same_clean["before_validate"] if same_clean else r["reachable"]
        i = worst(gap(r["before_validate"], best))
        b, a, possible = r["before_validate"][i], r["after_validate"][i], r["reachable"][i]
        verdict = verdicts(r)[0][0]
        is_material = material(r, same_clean)
        if r["kind"] == "single" and verdict in ("exact", "pair"):
            reached.append((a / max(1e-9, possible), is_material))
            if same_clean:
                within.append((a <= 1.2 * best[i], is_material))
        if r["kind"] == "unlisted" and is_material and r["truth"][0]["name"] not in effects.CLASS_SINCE:
            removed.append((b - a) / max(1e-9, b - best[i]))
        mark = {True: "material", False: "", None: "?"}[is_material]
        free = f"{best[i]:9.2f}" if same_clean else f"{'?':>9}"
        print(f"  {truth_text(r):34} {WEIGHTS[r['strength']]:6} {verdict:6}{mark:9}{b:9.2f}{a:9.2f}{free}{possible:9.2f}")
    print(f"named effects whose error afterwards is at most 1.2 times the clean recording's: {share(sum(1 for w in within if w[0]), len(within))}; "
          f"material ones {share(sum(1 for w in within if w[0] and w[1]), sum(1 for w in within if w[1]))}")
    for most in (1.2, 1.3):
        print(f"at most {most} times what was reachable: {share(sum(1 for ratio, _ in reached if ratio <= most), len(reached))}; "
              f"material ones {share(sum(1 for ratio, big in reached if big and ratio <= most), sum(1 for _, big in reached if big))}")
    print(f"material effects without a class with at least half of the excess removed: {share(sum(1 for x in removed if x >= 0.5), len(removed))}")


def summary(results):
    done = [r for r in results if "failed" not in r]
    clean_group = [r for r in done if r["kind"] == "clean"]
    clean = {r["setting"]: r for r in clean_group}
    touched = sum(1 for r in clean_group if r["effects"])
    print(f"\n{len(done)} records traced, {len(results) - len(done)} failed")
    for r in results:
        if "failed" in r:
            print("  " + line(r))
    print(f"clean records: {len(clean_group)}, touched {touched}; rate below {100 * clopper_pearson_upper(touched, len(clean_group)):.1f} % (95 %, Clopper-Pearson)")
    absorbed = [r for r in done if r["kind"] == "absorbed"]
    print(f"effects that the base parameters absorb: {len(absorbed)} records, {sum(1 for r in absorbed if not r['effects'])} left alone")
    confusion(done)
    detection(done, clean)
    sizes(done, clean)
    errors(done, clean)
    wrong = [verdicts(r)[1] for r in done]
    listed = [verdicts(r)[1] for r in done if r["kind"] != "unlisted"]
    if done:
        print(f"\nwrong terms per record: {sum(wrong) / len(done):.2f}; without the unlisted effects {sum(listed) / max(1, len(listed)):.2f}")
        seconds = sorted(r["seconds"] for r in done)
        print(f"seconds per trace (elapsed, several at once): median {seconds[len(seconds) // 2]:.1f}, longest {seconds[-1]:.1f}")
