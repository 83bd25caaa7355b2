"""Four CiA 402 drives made of the canopen library: an independent peer for our controller. Prints `ready`, then runs until it is
ended; on SIGTERM it prints what was done to its drives."""
import signal
import struct
import sys
import threading

import canopen
from canopen.sdo import SdoAbortedError

import dictionary

STATUS = {"disabled": 0x0250, "ready": 0x0231, "on": 0x0233, "enabled": 0x0237, "quick stop": 0x0217, "fault": 0x0218}


class Drive:
    def __init__(self, network, node_id, table):
        self.node = canopen.LocalNode(node_id, dictionary.load(table))
        network.add_node(self.node)
        self.network = network
        self.id = node_id
        self.state = "disabled"
        self.history = ["disabled"]
        self.torques_before_enabled = 0
        self.staged = {}
        self.position = 1000 * node_id
        self.node.add_write_callback(self.written)
        self.node.add_read_callback(self.read)
        network.subscribe(0, self.network_command)
        network.subscribe(0x80, self.sync)
        self.boot()

    def boot(self):
        self.node.data_store.clear()
        self.staged.clear()
        self.node.nmt.send_command(129)
        self.node.nmt.send_command(128)

    def network_command(self, can_id, data, timestamp):
        command, node = data[0], data[1]
        if node not in (0, self.id):
            return
        if command in (129, 130):
            self.boot()
        elif command == 1:
            for maps, incoming in ((self.node.rpdo, True), (self.node.tpdo, False)):
                for number in (1, 2):
                    maps[number].read()
                    if incoming and maps[number].enabled:
                        maps[number].callbacks = [self.received]

    def read(self, index, subindex, od):
        return {0x6041: STATUS[self.state], 0x6064: self.position, 0x6061: self.stored(0x6060)}.get(index)

    def stored(self, index):
        data = self.node.data_store.get(index, {}).get(0)
        return struct.unpack("b", data)[0] if data else 0

    def written(self, index, subindex, od, data):
        if index == 0x6040:
            self.control(struct.unpack("<H", data)[0])
        if index == 0x6060 and data[0] != 10:
            raise SdoAbortedError(0x06090030)

    def received(self, pdo):
        values = {variable.index: variable.raw for variable in pdo.map}
        if pdo.trans_type > 240:
            self.apply(values)
        else:
            self.staged.update(values)

    def apply(self, values):
        if 0x6040 in values:
            self.control(values[0x6040])
        if values.get(0x6071, 0) != 0 and self.state != "enabled":
            self.torques_before_enabled += 1

    def sync(self, can_id, data, timestamp):
        if self.node.nmt.state != "OPERATIONAL":
            return
        self.apply(self.staged)
        self.staged = {}
        self.position += 1
        for number in (1, 2):
            pdo = self.node.tpdo[number]
            if not pdo.enabled:
                continue
            for variable in pdo.map:
                if variable.index in (0x6041, 0x6064):
                    variable.raw = self.read(variable.index, 0, None)
            pdo.transmit()

    def control(self, word):
        state = self.state
        if not word & 0x02:
            state = "disabled" if state != "fault" else state
        elif not word & 0x04:
            state = "disabled"
        elif word & 0x0F == 0x06:
            state = "ready" if state in ("disabled", "on", "enabled", "ready") else state
        elif word & 0x0F == 0x07:
            state = "on" if state in ("ready", "enabled", "on") else state
        elif word & 0x0F == 0x0F:
            state = "enabled" if state in ("on", "enabled") else state
        if state != self.state:
            self.state = state
            self.history.append(state)


def main(channel, table):
    network = canopen.Network()
    network.connect(interface="socketcan", channel=channel)
    drives = [Drive(network, node, table) for node in (1, 2, 3, 4)]
    stop = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: stop.set())
    print("ready", flush=True)
    stop.wait()
    for drive in drives:
        print(f"node {drive.id}: {' > '.join(drive.history)}; torques before enabled: {drive.torques_before_enabled}")
    network.disconnect()


main(*sys.argv[1:])
