"""pip's settings for the network, for uv, which reads no pip.conf: package index, proxy, certificates.

    python -m course_kit.setup.environment.installer < pip config list

prints NAME=value lines for the environment of both. What the user has set for uv stays.
"""

from __future__ import annotations

import ast
import os
import sys
from collections.abc import Iterable, Mapping

# The certificates that the machine trusts: Debian, Fedora, SUSE.
SYSTEM_CERTIFICATES = (
    "/etc/ssl/certs/ca-certificates.crt",
    "/etc/pki/tls/certs/ca-bundle.crt",
    "/etc/ssl/ca-bundle.pem",
)
# pip's option -> the variables by which uv knows it; the first is set unless one of them is.
FOR_UV = {
    "index-url": ("UV_DEFAULT_INDEX", "UV_INDEX_URL", "UV_INDEX"),
    "proxy": ("HTTPS_PROXY", "https_proxy", "ALL_PROXY", "all_proxy"),
    "cert": ("SSL_CERT_FILE",),
}


def settings(lines: Iterable[str]) -> dict[str, str]:
    """The values of pip's options from lines such as "global.index-url='https://…'"; later ones count."""
    found = {}
    for line in lines:
        name, equals, value = line.strip().partition("=")
        if equals and name.rpartition(".")[0] in ("global", "install", ":env:"):
            found[name.rpartition(".")[2]] = str(ast.literal_eval(value))
    return found


def variables(pip: Mapping[str, str], environ: Mapping[str, str], certificates: Iterable[str]) -> dict[str, str]:
    """What to set for uv and pip."""
    wanted = {
        names[0]: pip[option]
        for option, names in FOR_UV.items()
        if option in pip and not any(environ.get(name) for name in names)
    }
    system = next((path for path in certificates if os.access(path, os.R_OK)), None)
    trusted = environ.get("SSL_CERT_FILE") or wanted.get("SSL_CERT_FILE") or system
    if trusted and not (environ.get("REQUESTS_CA_BUNDLE") or environ.get("CURL_CA_BUNDLE")):
        wanted["REQUESTS_CA_BUNDLE"] = trusted  # for pip: an older one brings certificates of its own
    if system and not environ.get("UV_SYSTEM_CERTS"):
        wanted["UV_SYSTEM_CERTS"] = "true"  # uv brings its own too
    return wanted


if __name__ == "__main__":
    for name, value in variables(settings(sys.stdin), os.environ, SYSTEM_CERTIFICATES).items():
        print(f"{name}={value}")
