"""Between the network and the pages: who asks, from where, and whether a browser was tricked into asking."""
import hmac
import json

from aiohttp import web

from .access import may
from .answer import Refused

COOKIE = "knee_session"
LARGEST_BODY = 65_536
_LOCAL_NAMES = ("127.0.0.1", "localhost", "[::1]")
_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
                               "form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff", "X-Frame-Options": "DENY", "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Resource-Policy": "same-origin"}


def refusal(status, sentence):
    return web.json_response({"success": False, "message": sentence}, status=status)


@web.middleware
async def guarded(request, handler):
    """Host names that are not ours, requests by other sites, and errors without a sentence end here; every answer gets its headers."""
    try:
        _require_own_host(request)
        if request.method not in ("GET", "HEAD") or "upgrade" in request.headers.get("Connection", "").lower():
            _require_own_origin(request)
        answer = await handler(request)
    except Refused as error:
        answer = refusal(error.status, str(error))
    except web.HTTPException as error:
        answer = refusal(error.status, {404: "there is no such page", 405: "not asked for in this way",
                                        413: f"the request is larger than {LARGEST_BODY} bytes"}.get(error.status, error.reason))
    if answer.prepared:  # a WebSocket that has ended
        return answer
    for name, value in _HEADERS.items():
        answer.headers.setdefault(name, value)
    if request.app["settings"].tls:
        answer.headers["Strict-Transport-Security"] = "max-age=31536000"
    if request.path.startswith("/api/"):
        answer.headers.setdefault("Cache-Control", "no-store")
    return answer


def _require_own_host(request):
    """A name server of somebody else's that resolves to our address (DNS rebinding) gives itself away by the Host header."""
    name = request.headers.get("Host", "").rsplit(":", 1)[0] if not request.headers.get("Host", "").endswith("]") else request.headers["Host"]
    if name.lower() not in request.app["settings"].host_names:
        raise Refused(421, "this host name is not the server's; see the parameter host_names")


def _require_own_origin(request):
    """Browsers say where a request comes from. Programs that are no browsers say nothing, and have no cookie by accident."""
    origin = request.headers.get("Origin")
    scheme = "https" if request.app["settings"].tls else "http"
    if origin is not None and origin.lower() != f"{scheme}://{request.headers.get('Host', '').lower()}":
        raise Refused(403, "requests from other sites are refused")
    if origin is None and request.headers.get("Sec-Fetch-Site", "same-origin") not in ("same-origin", "none"):
        raise Refused(403, "requests from other sites are refused")


def local_names():
    return set(_LOCAL_NAMES)


def session_of(request):
    """The session, or Refused (401)."""
    session = request.app["local_session"] or request.app["sessions"].find(request.cookies.get(COOKIE))
    if session is None:
        raise Refused(401, "log in first")
    return session


def needs(role):
    """Decorates a handler `(request, session)`: the role at least, and for everything that changes something the token of the page."""
    def decorate(handler):
        async def checked(request):
            session = session_of(request)
            if request.method not in ("GET", "HEAD"):
                token = request.headers.get("X-CSRF-Token", "")
                if not hmac.compare_digest(token.encode(), session.csrf.encode()):
                    raise Refused(403, "the page is out of date; load it again")
            if not may(session.role, role):
                request.app["audit"].add("refused", f"{request.method} {request.path}: needs the role {role}", user=session.user,
                                         role=session.role, address=request.remote)
                raise Refused(403, f"this needs the role '{role}'; you are logged in as '{session.role}'")
            return await handler(request, session)
        return checked
    return decorate


async def fields(request, **kinds):
    """The JSON object of a request with exactly the `kinds` (name=type or (type, default)); Refused (400, 415) otherwise."""
    if request.content_type != "application/json":
        raise Refused(415, "the request must be JSON")
    try:
        content = json.loads(await request.text(), parse_constant=lambda name: (_ for _ in ()).throw(ValueError(name)))
    except (ValueError, RecursionError, LookupError):
        raise Refused(400, "the request is no JSON") from None
    if not isinstance(content, dict):
        raise Refused(400, "the request must be a JSON object")
    for name in content:
        if name not in kinds:
            raise Refused(400, f"the request has a field '{name[:40]}' that is not known here")
    values = {}
    for name, kind in kinds.items():
        kind, default = kind if isinstance(kind, tuple) else (kind, None)
        value = content.get(name, default)
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise Refused(400, f"the request needs '{name}' ({kind.__name__})")
        values[name] = value
    return values
