"""Short reference files for the rostests, generated."""
import math
import pathlib

PERIOD = 0.01


def smooth(x):
    """Minimum jerk from 0 to 1."""
    x = min(max(x, 0.0), 1.0)
    return x**3 * (10 - 15 * x + 6 * x**2)


def rise(duration, height=0.03, angle_deg=2.0, home=(0.0, 0.6, 0.0, 0.0)):
    """Platform points: up and turned (psi) in half of the time, and back."""
    count = int(round(duration / PERIOD))
    for k in range(count + 1):
        s = smooth(2 * k / count) - smooth(2 * k / count - 1)
        yield home[0], home[1] + s * height, home[2], home[3] + s * math.radians(angle_deg)


def write(folder, name, points, space="platform"):
    text = f"# space: {space}\n" + "".join(" ".join(f"{v:.9f}" for v in point) + "\n" for point in points)
    (pathlib.Path(folder) / name).write_text(text)
    return name
