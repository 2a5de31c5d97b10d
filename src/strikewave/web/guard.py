"""Who may speak to the app: this machine, or who knows the token; no other page that a browser happens to show.

A page of another origin can make a browser send requests here, and by DNS rebinding even read the answers. So every
request and every websocket must name this server as its host, and none may come from another origin. What is sent here
has a size that is known before it is kept.
"""

from __future__ import annotations

import hmac
import ipaddress
import socket
from collections.abc import Awaitable, Callable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs, urlsplit

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
App = Callable[[Scope, Receive, Send], Awaitable[None]]

LARGEST_UPLOAD = 256 << 20
"""Most bytes of one request: a record of 30 million samples in single precision, or 20 of a million as text."""
COOKIE = "strikewave-token"
POLICY = "; ".join(
    (
        "default-src 'self'",
        "script-src 'self' 'unsafe-inline' 'unsafe-eval'",  # the kit of the pages is written so
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        "connect-src 'self' ws: wss:",
        "frame-src 'self' blob: data:",
        "object-src 'none'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'self'",
    )
)
HEADERS = (
    (b"content-security-policy", POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-resource-policy", b"same-origin"),
)


def is_own_host(host: str, names: frozenset[str]) -> bool:
    """Tell whether the host that a request names is this machine: by number, or by one of its names.

    A name of somebody else that was made to lead here is not; a number cannot be made to.

    Examples
    --------
    >>> names = frozenset({"localhost"})
    >>> [is_own_host(host, names) for host in ("127.0.0.1:8080", "[::1]:8080", "localhost", "evil.example:8080", "")]
    [True, True, True, False, False]
    """
    try:
        name = urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return False
    if name in names:
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def is_own_origin(origin: str, host: str) -> bool:
    """Tell whether a page comes from the server that it speaks to.

    Examples
    --------
    >>> is_own_origin("http://127.0.0.1:8080", "127.0.0.1:8080"), is_own_origin("http://127.0.0.1:9", "127.0.0.1:8080")
    (True, False)
    >>> is_own_origin("null", "127.0.0.1:8080")
    False
    """
    parts = urlsplit(origin)
    return parts.scheme in ("http", "https") and parts.netloc.lower() == host.lower()


class Guard:
    """Refuses what must not come in, before anything else sees it.

    Parameters
    ----------
    app : ASGI application
        What is guarded.
    token : str
        Who comes must know it; empty where only this machine can come.
    """

    def __init__(self, app: App, token: str = "") -> None:
        self.app, self._token = app, token
        self._names = frozenset({"localhost", socket.gethostname().lower()})

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what may come in, or say why not."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        status, reason = self._refusal(scope, headers)
        if reason:
            await _refuse(scope, send, status, reason)
            return
        given = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        await self.app(scope, _bounded(receive), self._with_headers(send, given))

    def _refusal(self, scope: Scope, headers: dict[str, str]) -> tuple[int, str]:
        """Return status and reason for what is not let in; an empty reason for what is."""
        host = headers.get("host", "")
        if not is_own_host(host, self._names):
            return 421, "this is strikewave on this machine, and it answers to its own address alone"
        if "origin" in headers and not is_own_origin(headers["origin"], host):
            return 403, "a page of another origin may not speak to this server"
        if headers.get("sec-fetch-site") == "cross-site" and headers.get("sec-fetch-mode") != "navigate":
            return 403, "a page of another origin may not speak to this server"
        if self._token and not self._knows_token(scope, headers):
            return 401, "open the whole address that strikewave printed when it started: it holds the token"
        length = headers.get("content-length", "0")
        if not length.isdigit() or int(length) > LARGEST_UPLOAD:
            return 413, f"at most {LARGEST_UPLOAD >> 20} MB at a time: cut the file, or use `strikewave record` on it"
        return 200, ""

    def _knows_token(self, scope: Scope, headers: dict[str, str]) -> bool:
        given = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        try:
            kept = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
        except CookieError:
            kept = None
        words = [given] if kept is None else [given, kept.value]
        return any(hmac.compare_digest(word.encode(), self._token.encode()) for word in words)

    def _with_headers(self, send: Send, given: str) -> Send:
        more = list(HEADERS)
        if self._token and given == self._token:
            more.append((b"set-cookie", f"{COOKIE}={self._token}; HttpOnly; SameSite=Strict; Path=/".encode()))

        async def sent(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                there = {name.lower() for name, _ in message.get("headers", [])}
                message["headers"] = [*message.get("headers", []), *(row for row in more if row[0] not in there)]
            await send(message)

        return sent


def _bounded(receive: Receive) -> Receive:
    """Return what receives a request, and ends it where it is larger than it may be, whatever it said of its size."""
    size = 0

    async def received() -> MutableMapping[str, Any]:
        nonlocal size
        message = await receive()
        if message["type"] == "http.request":
            size += len(message.get("body", b""))
            if size > LARGEST_UPLOAD:
                return {"type": "http.disconnect"}
        return message

    return received


async def _refuse(scope: Scope, send: Send, status: int, reason: str) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": reason})
        return
    headers = [(b"content-type", b"text/plain; charset=utf-8"), (b"connection", b"close"), *HEADERS]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": f"{reason}\n".encode()})
