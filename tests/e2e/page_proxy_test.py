#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The page behind a reverse proxy with TLS, by the Caddyfile of docs/guide/record.md (Debian's caddy).

usage: own_network.sh page_proxy_test.py --mixrig PROGRAM --guide docs/guide/record.md
Runs in a network of its own, since the proxy also opens the ports 80 and 443. Exit 77 without caddy.
"""
import argparse
import http.client
import json
import os
import pathlib
import re
import shutil
import ssl
import subprocess
import sys
import tempfile

HOST = "localhost"
LIMIT_S = 120  # of one answer, for a test that would hang


def request(method, path, port=443, host=HOST, tls=True, body=None, **headers):
    context = ssl._create_unverified_context()  # the certificate is of the proxy's own authority
    client = (http.client.HTTPSConnection(HOST, port, timeout=LIMIT_S, context=context) if tls
              else http.client.HTTPConnection("127.0.0.1", port, timeout=LIMIT_S))
    client.request(method, path, body, {"Host": host, **headers})
    answer = client.getresponse()
    return answer.status, dict(answer.getheaders()), answer.read() if answer.status != 101 else b""


def check(what, found, wanted):
    if found != wanted:
        sys.exit(f"page_proxy_test: {what}: {found}, not {wanted}")


def line_with(stream, word):
    for line in stream:
        if word in line:
            return line
    sys.exit(f"page_proxy_test: it ended without '{word}'")


def write_caddyfile(guide, file):
    """The guide's Caddyfile, for this host; this machine's list of authorities stays as it is."""
    found = re.search(r"^rig\.example \{\n.*?^\}\n", guide.read_text(), re.M | re.S)
    if not found:
        sys.exit("page_proxy_test: no Caddyfile in the guide")
    file.write_text("{\n  skip_install_trust\n  admin off\n}\n" + found[0].replace("rig.example", HOST))


def use_page(token):
    check("without the token", request("GET", "/")[0], 401)
    status, headers, _ = request("GET", f"/?token={token}")
    check("first visit", status, 303)
    cookie = headers["Set-Cookie"]
    check("cookie", "; Secure" in cookie, True)
    own = {"Cookie": cookie.split(";")[0], "Origin": f"https://{HOST}"}
    check("page", request("GET", "/", **own)[0], 200)
    change = {"body": json.dumps({"view": "plate"}), "Content-Type": "application/json"}
    check("change", request("PUT", "/api/v1/view", **change, **own)[0], 200)
    check("change of another site", request("PUT", "/api/v1/view", **change, **{**own, "Origin": "https://evil.example"})[0], 403)
    upgrade = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13",
               "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ=="}
    check("events", request("GET", "/api/v1/event/websocket", **upgrade, **own)[0], 101)
    # Past the proxy, the host that a client forwards is not believed.
    forwarded = {**own, "Origin": "https://evil.example", "X-Forwarded-Host": "evil.example"}
    check("forwarded host", request("PUT", "/api/v1/view", 8437, HOST, False, **change, **forwarded)[0], 403)


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--mixrig", required=True)
    options.add_argument("--guide", required=True, type=pathlib.Path)
    options = options.parse_args()
    if shutil.which("caddy") is None:
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        take = pathlib.Path(folder) / "take"
        subprocess.run([options.mixrig, "studio", take, "--plain", "--scenario", "walk", "--rig", "sr3000", "--seed", "3",
                        "--size", "64x48", "--frames", "8"], check=True, stdout=subprocess.DEVNULL)
        run = subprocess.Popen([options.mixrig, "run", take / "scene.toml", "--source", f"take:{take}", "--backend", "cpu",
                                "--page", "--page-proxy", HOST], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        environment = {**os.environ, "HOME": folder, "XDG_DATA_HOME": folder, "XDG_CONFIG_HOME": folder}
        caddyfile = pathlib.Path(folder) / "Caddyfile"
        write_caddyfile(options.guide, caddyfile)
        proxy = subprocess.Popen(["caddy", "run", "--config", caddyfile], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                                 env=environment)
        try:
            url = line_with(run.stderr, "page: ").split()[1]
            check("address", url.startswith(f"https://{HOST}/?token="), True)
            line_with(proxy.stderr, "serving initial configuration")
            use_page(url.split("=")[1])
        finally:
            for child in (proxy, run):
                child.terminate()
                child.communicate()


main()
