"""Where the server listens and what it may reach; refuses what would expose the robot by mistake."""
import dataclasses
import ipaddress
import pathlib
import ssl

from .access import ROLES, InputError, Users
from .guard import local_names


@dataclasses.dataclass
class Settings:
    references: str
    patients: str
    recordings: str
    reports: str
    log: str
    robot: str
    address: str = "127.0.0.1"
    port: int = 8080
    certificate: str = ""      # PEM, with its chain
    key: str = ""
    users: str = ""            # needed beyond loopback
    host_names: tuple = ()     # further names under which browsers reach the server
    local_role: str = "engineer"
    lost_page_pause_s: float = 0.0  # 0: a lost page changes nothing
    model_in_use: str = ""

    def __post_init__(self):
        self.tls = bool(self.certificate)
        try:
            self.is_local = ipaddress.ip_address(self.address).is_loopback
        except ValueError:
            raise InputError(f"address '{self.address}' is no IP address; 127.0.0.1 keeps the page on this computer") from None
        if not 0 <= self.port <= 65535:
            raise InputError(f"port {self.port} is outside 0 .. 65535")
        if self.local_role not in ROLES:
            raise InputError(f"local_role '{self.local_role}' is none of {', '.join(ROLES)}")
        if bool(self.certificate) != bool(self.key):
            raise InputError("certificate and key belong together: give both or none")
        if not self.is_local and not (self.tls and self.users):
            raise InputError(f"address {self.address} is reached from the network: certificate, key and users are needed there "
                             "(docs/operator.md), or address:=127.0.0.1")
        names = {self.address.lower(), f"[{self.address.lower()}]", *(n.lower() for n in self.host_names)}
        self.host_names = names | local_names()

    def load_users(self):
        return Users(self.users) if self.users else None

    def tls_context(self):
        if not self.tls:
            return None
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        try:
            context.load_cert_chain(self.certificate, self.key)
        except (OSError, ssl.SSLError) as error:
            raise InputError(f"{self.certificate}, {self.key}: no certificate with its key ({error})") from None
        return context

    def make_folders(self):
        for folder in (self.references, self.patients, self.recordings, self.reports, self.log):
            pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
