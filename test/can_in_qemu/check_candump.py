"""Judges a `candump -L` log of our controller with four drives, nodes 1 to 4. Prints `ok NAME` or `not ok NAME: why` lines."""
import re
import sys

STATE = {0x40: "disabled", 0x21: "ready", 0x23: "on", 0x27: "enabled"}


def read(path):
    frames = []
    for line in open(path):
        found = re.match(r"\(([\d.]+)\) \S+ ([0-9A-F]+)#([0-9A-F]*)", line)
        if found:
            frames.append((int(found[2], 16), bytes.fromhex(found[3])))
    return frames


def check(name, good, detail=""):
    print(f"ok {name}" if good else f"not ok {name}: {detail}", flush=True)
    return bool(good)


def cyclic(frames):
    """Of each period between two SYNCs: commands and feedbacks by node, in order."""
    starts = [i for i, (can_id, data) in enumerate(frames) if can_id == 0 and data[:1] == b"\x01"]
    periods, commands, feedbacks = [], [], []
    for can_id, data in frames[starts[-1] + 1:] if starts else []:
        node = can_id & 0x7F
        if can_id == 0x80:
            periods.append((commands, feedbacks))
            commands, feedbacks = [], []
        elif can_id == 0x200 + node:
            commands.append((node, data))
        elif can_id == 0x180 + node:
            feedbacks.append((node, data))
    return periods


def main(path, label):
    frames = read(path)
    good = check(f"{label}: candump: every node is reset and started",
                 {data for can_id, data in frames if can_id == 0} >=
                 {bytes((command, node)) for command in (1, 130) for node in (1, 2, 3, 4)}, "NMT commands are missing")
    periods = [period for period in cyclic(frames) if period[0]]
    good &= check(f"{label}: candump: one command of 4 bytes a drive before each SYNC",
                  len(periods) > 20 and all([node for node, data in commands] == [1, 2, 3, 4] and
                                            all(len(data) == 4 for _, data in commands) for commands, _ in periods),
                  f"{len(periods)} periods")
    answered = sum(sorted(node for node, _ in feedbacks) == [1, 2, 3, 4] for _, feedbacks in periods)
    good &= check(f"{label}: candump: four feedbacks of 8 bytes after nearly every SYNC",
                  answered > 0.9 * len(periods) and all(len(data) == 8 for _, f in periods for _, data in f),
                  f"{answered} of {len(periods)}")
    torques = [data[2:4] for commands, _ in periods for _, data in commands]
    good &= check(f"{label}: candump: torque stays 0", set(torques) == {b"\0\0"}, "torque before it was asked for")
    for node in (1, 2, 3, 4):
        words, states = [], []
        for commands, feedbacks in periods:
            for number, data in commands:
                word = data[0] | data[1] << 8
                if number == node and words[-1:] != [word]:
                    words.append(word)
            for number, data in feedbacks:
                state = STATE.get(data[0] & 0x6F, STATE.get(data[0] & 0x4F, "?"))
                if number == node and states[-1:] != [state]:
                    states.append(state)
        text = " ".join(f"{word:02X}" for word in words)
        good &= check(f"{label}: candump: node {node} is enabled and switched off step by step",
                      "06 07 0F 06" in text and "disabled ready on enabled" in " ".join(states), f"{text}; {states}")
    beats = [data for can_id, data in frames if can_id == 0x77E]
    good &= check(f"{label}: candump: the controller's heartbeat", len(beats) > 3 and set(beats) == {b"\x05"}, f"{len(beats)}")
    return 0 if good else 1


sys.exit(main(*sys.argv[1:]))
