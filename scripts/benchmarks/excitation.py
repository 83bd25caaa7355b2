#!/usr/bin/python3
"""Excitation planning beside SciPy's SLSQP, at equal k: ratios of processor time, one thread each.

Both get the same cost (log k, smoothed with the same three exponents in turn), the same limits and the same starts; SciPy calls our
compiled cost, once with our exact gradients and once with its own finite differences. For each start the k to be reached is the
worse of the two final ones; a ratio above 1 says that SciPy took that many times as long, and "not reached" that it did not get
there. k is that of a series drawn back to all limits. Started by scripts/benchmark_peers.

Usage: excitation.py LIBRARY ROBOT [--starts N] [--iterations N] [--seconds S] [--markdown FILE]
"""
import argparse
import ctypes
import math
import time

import numpy
import scipy
from scipy.optimize import minimize

EXPONENTS = (2.0, 8.0, 32.0)
REACH = 0.3  # of one round in each variable, as in our search
KEPT = 1e-4


def array(values):
    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


class Peer:
    """The shared library; counts every call."""

    def __init__(self, path, robot, velocity, duration, directions, iterations):
        self.lib = ctypes.CDLL(path)
        self.lib.peer_feasible_k.restype = ctypes.c_double
        sizes = (ctypes.c_int * 2)()
        self.starts = self.lib.peer_open(robot.encode(), ctypes.c_double(velocity), ctypes.c_double(duration), directions, iterations,
                                         sizes)
        self.variables, self.limits = sizes

    def start(self, number):
        x = numpy.empty(self.variables)
        self.lib.peer_start(number, array(x))
        return x

    def evaluate(self, x, exponent, slopes):
        x = numpy.ascontiguousarray(x)
        cost, limits = numpy.empty(1), numpy.empty(self.limits)
        gradient = numpy.empty(self.variables) if slopes else None
        gradients = numpy.empty((self.limits, self.variables)) if slopes else None
        ok = self.lib.peer_evaluate(array(x), ctypes.c_double(exponent), array(cost), array(limits),
                                    array(gradient) if slopes else None, array(gradients) if slopes else None)
        if not ok:
            return 1e6, numpy.full(self.limits, 1e3), numpy.zeros(self.variables), numpy.zeros((self.limits, self.variables))
        return cost[0], limits, gradient, gradients

    def feasible_k(self, x):
        x = numpy.ascontiguousarray(x)
        return self.lib.peer_feasible_k(array(x))

    def ours(self, number):
        times, ks = numpy.empty(1000), numpy.empty(1000)
        count = self.lib.peer_ours(number, 1000, array(times), array(ks))
        return list(zip(times[:count], ks[:count]))


class OutOfTime(Exception):
    pass


def scipys(peer, number, exact, iterations, seconds):
    """[(processor seconds, best k so far)] of SciPy's SLSQP from one start, in three rounds from the best so far."""
    begin, aside = time.process_time(), 0.0
    best = peer.start(number)
    trace = [(0.0, peer.feasible_k(best))]
    last = {}

    def at(x, exponent):
        key = x.tobytes()
        if last.get("key") != key:
            if time.process_time() - begin - aside > seconds:
                raise OutOfTime
            last["key"], last["value"] = key, peer.evaluate(x, exponent, exact)
        return last["value"]

    def note(x):
        nonlocal best, aside
        before = time.process_time()  # drawing a series back to the limits to judge it is not SciPy's work
        k = peer.feasible_k(x)
        aside += time.process_time() - before
        if k < trace[-1][1]:
            best = numpy.array(x)
            trace.append((time.process_time() - begin - aside, k))

    for exponent in EXPONENTS:
        last.clear()
        from_here = best.copy()
        try:
            result = minimize(lambda x: at(x, exponent)[0], from_here, method="SLSQP", callback=note,
                              jac=(lambda x: at(x, exponent)[2]) if exact else None,
                              bounds=[(v - REACH, v + REACH) for v in from_here],
                              constraints={"type": "ineq", "fun": lambda x: KEPT - at(x, exponent)[1],
                                           **({"jac": lambda x: -at(x, exponent)[3]} if exact else {})},
                              options={"maxiter": iterations, "ftol": 1e-4})
            note(result.x)
        except OutOfTime:
            break
    return trace


def time_to(trace, k):
    return next((t for t, reached in trace if reached <= k * 1.0001), math.inf)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("library")
    parser.add_argument("robot")
    parser.add_argument("--starts", type=int, default=3)
    parser.add_argument("--iterations", type=int, default=150, help="of each of three rounds")
    parser.add_argument("--seconds", type=float, default=60.0, help="of processor time that SciPy gets for each start")
    parser.add_argument("--velocity", type=float, default=0.01)
    parser.add_argument("--duration", type=float, default=20.0)
    parser.add_argument("--directions", type=int, default=51)
    parser.add_argument("--markdown", help="file to write the table to as well")
    a = parser.parse_args()
    peer = Peer(a.library, a.robot, a.velocity, a.duration, a.directions, a.iterations)
    print(f"SLSQP of SciPy {scipy.__version__}: {peer.variables} variables, {peer.limits} limits, k at r = {a.directions}, {a.duration:g} s, "
          f"{a.velocity:g} m/s; processor seconds of one thread")
    print(f"{'start':>6}{'first k':>10} | {'ours: k':>9}{'s':>7} | {'SciPy, exact gradients: k':>26}{'s':>7}{'equal k':>9}{'ratio':>7} | "
          f"{'SciPy, differences: k':>22}{'s':>7}{'equal k':>9}{'ratio':>7}")
    ratios = {True: [], False: []}
    lines = [f"Excitation, k at r = {a.directions} ({a.duration:g} s, {a.velocity:g} m/s), SLSQP of SciPy {scipy.__version__}; s of processor time "
             "from one start:\n",
             "| start | first k | ours: k | s | SciPy, our gradients: k | s | s to equal k: SciPy / ours | SciPy, differences: k | s | "
             "s to equal k: SciPy / ours |", "|" + " --- |" * 10]
    for number in range(min(a.starts, peer.starts)):
        own = peer.ours(number)
        line = f"| {number + 1} | {own[0][1]:.1f} | {own[-1][1]:.1f} | {own[-1][0]:.1f} |"
        row = f"{number + 1:6}{own[0][1]:10.1f} | {own[-1][1]:9.1f}{own[-1][0]:7.1f}"
        for exact in (True, False):
            other = scipys(peer, number, exact, a.iterations, a.seconds)
            k = max(own[-1][1], other[-1][1])
            mine, theirs = time_to(own, k), time_to(other, k)
            ratio = theirs / max(mine, 1e-3) if theirs > 0.0 else math.nan
            ratios[exact].append(ratio)
            row += f" | {other[-1][1]:{26 if exact else 22}.1f}{other[-1][0]:7.1f}{k:9.1f}" + (f"{ratio:7.1f}" if theirs > 0 else f"{'-':>7}")
            line += (f" {other[-1][1]:.1f} | {other[-1][0]:.1f} | {mine:.2f} s, " +
                     (f"{ratio:.1f}" if math.isfinite(ratio) else "not reached" if theirs > 0 else "no better than the start") + " |")
        print(row, flush=True)
        lines.append(line)
    summary = []
    for exact, name in ((True, "our exact gradients"), (False, "its own differences")):
        finite = sorted(r for r in ratios[exact] if math.isfinite(r))
        if finite:
            summary.append(f"SciPy with {name}: median {finite[len(finite) // 2]:.1f} times our time to equal k"
                           + ("   MISSED" if finite[len(finite) // 2] < 1.0 else ""))
        else:
            summary.append(f"SciPy with {name}: never found a better series than the start")
    print("\n".join(summary))
    if a.markdown:
        with open(a.markdown, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n\n" + "\n".join(f"- {line}" for line in summary) + "\n")


if __name__ == "__main__":
    main()
