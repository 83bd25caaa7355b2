"""What aiohttp leaves open: how many connections there may be, how long a request may take to arrive, how long an answer to leave."""
import asyncio

from aiohttp import web
from aiohttp.web_protocol import RequestHandler

MOST_CONNECTIONS = 200
MOST_PER_ADDRESS = 40
FIRST_REQUEST_S = 10.0
BODY_S = 10.0
STOP = "/api/stop"


class _Connection(RequestHandler):
    """Closes itself when its first request has not arrived whole after FIRST_REQUEST_S. Later ones are bounded by keepalive_timeout."""

    def __init__(self, gate, *arguments, **options):
        super().__init__(*arguments, **options)
        self._gate = gate
        self._address = None
        self._deadline = None
        self.reads_body = False

    def connection_made(self, transport):
        super().connection_made(transport)
        peer = transport.get_extra_info("peername")
        self._address = peer[0] if peer else "?"
        if not self._gate.admit(self, self._address):
            self._address = None
            transport.abort()
            return
        self._deadline = asyncio.get_running_loop().call_later(self._gate.first_request_s, transport.abort)

    def request_arrived(self):
        if self._deadline:
            self._deadline.cancel()
            self._deadline = None

    @property
    def idle(self):
        """Nothing is being answered: the next request has not arrived, or not whole."""
        return self._current_request is None or self.reads_body

    def give_way(self):
        """To somebody who may have something to ask."""
        self._leave()
        self.transport.abort()

    def _leave(self):
        if self._address is not None:
            self._gate.leave(self, self._address)
            self._address = None

    def connection_lost(self, exc):
        self.request_arrived()
        self._leave()
        super().connection_lost(exc)


class Gate:
    """Counts the connections of each address. Where no more may be, the oldest idle one gives way: of the same address, or of the one that
    has most. A protocol factory: pass protocol() to loop.create_server."""

    def __init__(self, runner, first_request_s=FIRST_REQUEST_S, most=MOST_CONNECTIONS, most_per_address=MOST_PER_ADDRESS):
        self._server = runner.server
        self.first_request_s = first_request_s
        self._most, self._most_per_address = most, most_per_address
        self._open = {}  # address: its connections, the oldest first

    def admit(self, connection, address):
        own = self._open.get(address, [])
        if len(own) >= self._most_per_address:
            crowd = own
        elif sum(map(len, self._open.values())) >= self._most:
            crowd = max(self._open.values(), key=len)
        else:
            crowd = None
        if crowd is not None:
            idle = next((one for one in crowd if one.idle), None)
            if idle is None:
                return False
            idle.give_way()
        self._open.setdefault(address, []).append(connection)
        return True

    def leave(self, connection, address):
        self._open[address].remove(connection)
        if not self._open[address]:
            del self._open[address]

    def protocol(self):
        # What aiohttp's Server does when it is called, with our class.
        return _Connection(self, self._server, loop=asyncio.get_running_loop(), **self._server._kwargs)


@web.middleware
async def bounded_request(request, handler):
    """Notes that the request's head has arrived, and reads its body within BODY_S and the size that the application allows. STOP waits for no
    body."""
    connection = request.protocol
    connection.request_arrived()
    if request.body_exists and request.path != STOP:
        connection.reads_body = True
        try:
            await asyncio.wait_for(request.read(), request.app["body_s"])
        except asyncio.TimeoutError:
            answer = web.json_response({"success": False, "message": "the request took too long to arrive"}, status=408)
            answer.force_close()
            return answer
        finally:
            connection.reads_body = False
    return await handler(request)


async def serve(app, address, port, tls=None, **limits):
    """Starts serving; returns (listening server, coroutine function that ends it)."""
    runner = web.AppRunner(app, access_log=None, keepalive_timeout=15.0, lingering_time=1.0, tcp_keepalive=True, handle_signals=False)
    await runner.setup()
    gate = Gate(runner, **limits)
    handshake = {"ssl_handshake_timeout": gate.first_request_s} if tls else {}
    server = await asyncio.get_running_loop().create_server(gate.protocol, address, port, ssl=tls, backlog=64, reuse_address=True,
                                                            **handshake)

    async def end():
        server.close()
        await runner.shutdown()
        await runner.server.shutdown(2.0)
        await runner.cleanup()

    return server, end
