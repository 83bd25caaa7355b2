"""The canopen library's master against our simulated drives. Prints a line `ok NAME` or `not ok NAME: why` for each check."""
import sys
import time

import canopen
from canopen.sdo import SdoAbortedError

import dictionary


class Checks:
    def __init__(self):
        self.failed = 0

    def that(self, name, good, detail=""):
        print(f"ok {name}" if good else f"not ok {name}: {detail}", flush=True)
        self.failed += not good


def abort_of(action):
    try:
        action()
    except SdoAbortedError as error:
        return error.code
    return 0


def until(condition, seconds=10.0):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


def configure(node):
    feedback, command = node.tpdo[1], node.rpdo[1]
    for pdo, cob_id, objects in ((feedback, 0x180, (0x6041, 0x6064, 0x6077)), (command, 0x200, (0x6040, 0x6071))):
        pdo.clear()
        for index in objects:
            pdo.add_variable(index)
        pdo.cob_id, pdo.trans_type, pdo.enabled, pdo.rtr_allowed = cob_id + node.id, 1, True, False
        pdo.inhibit_time = 0 if pdo is feedback else None
        pdo.save()


def main(channel, table):
    checks = Checks()
    network = canopen.Network()
    network.connect(interface="socketcan", channel=channel)
    nodes = [network.add_node(canopen.BaseNode402(number, dictionary.load(table))) for number in (1, 2, 3, 4)]
    first = nodes[0]

    network.nmt.send_command(130)
    checks.that("peer master: boot-up after reset communication",
                until(lambda: all(node.nmt.timestamp is not None for node in nodes)), "no boot-up message")
    checks.that("peer master: identity", first.sdo[0x1018][1].raw == 0xFB and first.sdo[0x1000].raw & 0xFFFF == 402,
                hex(first.sdo[0x1018][1].raw))
    aborts = [abort_of(lambda: first.sdo.upload(0x2FFF, 0)), abort_of(lambda: first.sdo.upload(0x1018, 9)),
              abort_of(lambda: first.sdo.download(0x6041, 0, b"\0\0")), abort_of(lambda: first.sdo.download(0x6071, 0, b"\0"))]
    checks.that("peer master: abort codes", aborts == [0x06020000, 0x06090011, 0x06010002, 0x06070010],
                " ".join(map(hex, aborts)))

    for node in nodes:
        node.sdo[0x6060].raw = 10
        configure(node)
        node.sdo[0x6007].raw = 3
        node.sdo[0x1017].raw = 100
        node.sdo[0x1016][1].raw = 127 << 16 | 2000
    heartbeat = network.send_periodic(0x77F, [5], 0.1)
    network.nmt.state = "OPERATIONAL"
    checks.that("peer master: heartbeats of operational nodes",
                until(lambda: all(node.nmt._state_received == 5 for node in nodes)), "none")
    network.sync.start(0.05)
    checks.that("peer master: feedback after SYNC",
                all(node.tpdo[1].wait_for_reception(10) is not None for node in nodes), "none")

    def status(node):
        return node.tpdo[1][0x6041].raw & 0x6F

    def go_to(word, wanted):
        for node in nodes:
            node.rpdo[1][0x6040].raw = word
            node.rpdo[1].transmit()
        return until(lambda: all(status(node) == wanted for node in nodes))

    for word, wanted in ((0x06, 0x21), (0x07, 0x23), (0x0F, 0x27)):
        reached = go_to(word, wanted)
        checks.that(f"peer master: control word {word:02X} leads to status {wanted:02X}", reached,
                    " ".join(hex(status(node)) for node in nodes))
    first.rpdo[1][0x6071].raw = -100
    first.rpdo[1].transmit()
    checks.that("peer master: torque follows", until(lambda: first.tpdo[1][0x6077].raw in (-100, 65436)),
                str(first.tpdo[1][0x6077].raw))

    emergencies = {}
    for node in nodes:
        node.emcy.add_callback(lambda error, number=node.id: emergencies.setdefault(number, error.code))
    heartbeat.stop()
    checks.that("peer master: drives stop by themselves without its heartbeat",
                until(lambda: len(emergencies) == 4 and all(status(node) != 0x27 for node in nodes), 20),
                f"{emergencies} {[hex(status(node)) for node in nodes]}")
    checks.that("peer master: emergency 8130", set(emergencies.values()) == {0x8130}, str(emergencies))
    network.sync.stop()
    network.nmt.state = "PRE-OPERATIONAL"
    network.disconnect()
    return 1 if checks.failed else 0


sys.exit(main(*sys.argv[1:]))
