"""Whom the kernel ends where memory runs out: rather the page and what it computes than the controller."""
import os

PAGE, JOB = 500, 1000


def offer_itself(adjustment):
    """Everybody may make himself the sooner to be ended, and so are those that he starts."""
    try:
        with open("/proc/self/oom_score_adj", "w", encoding="ascii") as file:
            file.write(str(adjustment))
    except OSError:
        pass


def yielding(niceness=10):
    """Of a process that is about to become a program that computes: its processor time and its memory are others' first."""
    os.nice(niceness)
    offer_itself(JOB)
