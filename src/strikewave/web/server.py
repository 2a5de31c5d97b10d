"""The server of the app: pages, guard, address, and the browser that is opened on it."""

from __future__ import annotations

import contextlib
import errno
import ipaddress
import secrets
import socket
import threading
import time
import webbrowser
from pathlib import Path

import uvicorn
from fastapi import FastAPI
from nicegui import ui

from strikewave.base.errors import InputError
from strikewave.reporting.terminal import say
from strikewave.web.desk import make_desk
from strikewave.web.guard import Guard
from strikewave.web.pages.case import page as case_page
from strikewave.web.pages.case.kinds import KINDS
from strikewave.web.pages.record import page as record_page
from strikewave.web.pages.study import page as study_page

FAVICON = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32"><rect width="32" height="32" rx="6" fill="#0072b2"/>'
    '<path d="M3 24h7c3 0 3-16 6-16s3 16 6 16h7" fill="none" stroke="#fff" stroke-width="3"/></svg>'
)
RECONNECT = 30.0
"""Time that a browser may be away before its page is forgotten, s: a lid that was closed for a moment."""
LARGEST_MESSAGE = 1 << 20
"""Most bytes of one message of a page: a case file may have as many."""
SESSION = "strikewave-session"
"""Start of the name of the cookie of a browser's session; the port follows, as in that of the token."""


def is_loopback(host: str) -> bool:
    """Tell whether only this machine can reach a host."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def shown_address(listening: socket.socket, host: str) -> str:
    """Return the address for a browser of this machine, of a socket that listens at a host.

    An address that stands for all of this machine's is none that every browser opens: its loopback is shown.

    Examples
    --------
    >>> with socket.create_server(("0.0.0.0", 0)) as listening:
    ...     shown_address(listening, "0.0.0.0").rpartition(":")[0]
    'http://127.0.0.1'
    """
    bound, port = listening.getsockname()[:2]
    if ipaddress.ip_address(bound.partition("%")[0]).is_unspecified:
        host = "::1" if listening.family == socket.AF_INET6 else "127.0.0.1"
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def make_app(folder: Path | None, token: str = "", host: str = "", port: int = 0) -> Guard:
    """Return the guarded app: for holders of the token, at a host and port."""
    desk = make_desk(folder)
    for kind in KINDS:
        case_page.add(desk, kind)
    record_page.add(desk)
    study_page.add(desk)
    server = FastAPI(openapi_url=None, docs_url=None, redoc_url=None)
    ui.run_with(
        server,
        title="strikewave",
        language="en-US",
        favicon=FAVICON,
        reconnect_timeout=RECONNECT,
        tailwind=False,
        storage_secret=desk.sessions.secret,
        session_middleware_kwargs={
            "session_cookie": f"{SESSION}-{port}",
            "same_site": "strict",
            "max_age": 30 * 24 * 3600,
        },
        show_welcome_message=False,
    )
    return Guard(server, token, host, port)


def serve(host: str, port: int, folder: Path | None, browser: bool) -> None:
    """Serve the app until it is stopped."""
    listening = _listen(host, port)
    bound, port = listening.getsockname()[:2]
    token = "" if is_loopback(bound) else secrets.token_urlsafe(16)
    app = make_app(folder, token, host, port)
    address = f"{shown_address(listening, host)}/" + (f"?token={token}" if token else "")
    if token:
        say(
            f"warning: {host} can be reached by other machines, and what is sent is not encrypted. "
            "Whoever has the address below can run cases here; give it to nobody else"
        )
    say(f"strikewave app: {address}  (Ctrl-C ends it)")
    config = uvicorn.Config(
        app,
        log_level="error",
        ws_max_size=LARGEST_MESSAGE,
        timeout_graceful_shutdown=2,
        server_header=False,
        loop="asyncio",
    )
    server = uvicorn.Server(config)

    def open_browser() -> None:
        while not server.started and not server.should_exit:
            time.sleep(0.02)
        if not server.should_exit:
            webbrowser.open(address)

    if browser:  # once the server answers
        threading.Thread(target=open_browser, daemon=True).start()
    with contextlib.suppress(KeyboardInterrupt):
        server.run(sockets=[listening])


def _listen(host: str, port: int) -> socket.socket:
    """Return the socket on which the server listens, bound before anything else is done."""
    try:
        family, kind, _, _, place = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        listening = socket.socket(family, kind)
    except (OSError, ValueError) as error:  # ValueError: a name with an empty or too long part, or a zero byte
        raise InputError("--host", host, "a host of this machine", getattr(error, "strerror", None) or "") from None
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(place)
        listening.listen()  # a browser that is faster than the pages waits for them
    except OSError as error:
        listening.close()
        if error.errno == errno.EADDRNOTAVAIL:
            raise InputError("--host", host, "an address of this machine", error.strerror or "") from None
        hint = "another program has this port: choose another by --port, or 0 for any that is free"
        raise InputError("--port", str(port), "a free port of this machine", f"{error.strerror}; {hint}") from None
    return listening
