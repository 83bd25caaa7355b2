"""What the simulated robot really did: its truth log in shared memory (include/knee_robot/simulation/truth_log.h)."""
import numpy as np

MAGIC = 0x6B6E65655F747274
ROW = np.dtype([("monotonic_s", "f8"), ("time_s", "f8"), ("length_m", "f8", 4), ("pose", "f8", 4), ("volts", "f8", 4),
                ("force_N", "f8", 4), ("outputs", "u4"), ("drives", "u4"), ("holds", "u4"), ("faults", "u4")])
HEAD = 32
POWER_BITS = 3  # config/hardware/simulated.yaml: drive_enable and hold_release


def is_ready(path):
    """The log is there and has its first rows."""
    try:
        with open(path, "rb") as file:
            head = np.frombuffer(file.read(HEAD), dtype="u8")
    except FileNotFoundError:
        return False
    return len(head) == 4 and int(head[0]) == MAGIC and int(head[3]) > 10


class TruthLog:
    def __init__(self, name):
        self.path = "/dev/shm" + name + "_truth"
        self.memory = np.memmap(self.path, dtype=np.uint8, mode="r")
        head = self.memory[:HEAD].view("u8")
        if int(head[0]) != MAGIC or int(head[1]) != ROW.itemsize:
            raise RuntimeError(f"{self.path} is no truth log of this build")
        self.capacity = int(head[2])
        self.rows_ = self.memory[HEAD:HEAD + self.capacity * ROW.itemsize].view(ROW)

    def written(self):
        return int(self.memory[24:32].view("u8")[0])

    def last(self):
        return self.rows_[(self.written() - 1) % self.capacity].copy()

    def since(self, number):
        """All rows from row `number` on, in order."""
        end = self.written()
        first = max(number, end - self.capacity + 64)
        return self.rows_[np.arange(first, end) % self.capacity].copy()


def is_held(rows):
    return (rows["holds"] == 15) & (rows["drives"] == 0)
