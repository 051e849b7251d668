# SPDX-License-Identifier: BSD-3-Clause
"""What fetches the node modules for the LAS writer's test: without a network it says "Skipped" and how to get them (CTest
then calls it skipped); whatever else npm refuses is a failure."""
import http.server
import json
import os
import pathlib
import shutil
import ssl
import socket
import subprocess
import tempfile
import threading
import unittest

FILES = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Testing" / "IO"


def closed_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class TestNodeModules(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.source = self.folder / "source"
        self.source.mkdir()
        for name in ("package.json", "package-lock.json"):
            shutil.copy(FILES / name, self.source)

    def install(self, port, scheme="http"):
        """Exit code and words with the registry at a port of this machine, and nothing kept from before."""
        environment = {**os.environ, "npm_config_registry": f"{scheme}://127.0.0.1:{port}/",
                       "npm_config_cache": str(self.folder / "cache"), "npm_config_replace_registry_host": "always",
                       "no_proxy": "127.0.0.1", "npm_config_noproxy": "127.0.0.1"}
        run = subprocess.run(
            [os.environ["AVIANLIDAR_CMAKE"], "-D", f"NPM={shutil.which('npm')}", "-D", f"FROM={self.source}",
             "-D", f"TO={self.folder / 'modules'}", "-P", FILES / "InstallNodeModules.cmake"],
            env=environment, capture_output=True, text=True, timeout=200)
        self.assertFalse((self.folder / "modules" / "installed").exists())
        self.assertNotEqual(run.returncode, 0)
        return run.stdout + run.stderr

    def test_no_registry(self):
        words = self.install(closed_port())
        self.assertIn("Skipped: npm reaches no registry (ECONNREFUSED)", words)
        self.assertIn("run this test once with a network", " ".join(words.split()))

    @unittest.skipUnless(shutil.which("openssl"), "needs openssl to make a certificate")
    def test_a_network_with_a_certificate_of_its_own(self):
        key, certificate = self.folder / "key.pem", self.folder / "certificate.pem"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=127.0.0.1",
                        "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", certificate],
                       check=True, capture_output=True)
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(certificate, key)
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), http.server.BaseHTTPRequestHandler) as server:
            server.handle_error = lambda *_: None
            server.socket = context.wrap_socket(server.socket, server_side=True)
            threading.Thread(target=server.serve_forever, daemon=True).start()
            words = self.install(server.server_port, "https")
            server.shutdown()
        self.assertRegex(words, r"Skipped: npm reaches no registry \(\w*SELF_SIGNED_CERT")

    def test_a_registry_without_the_package(self):
        self.fails_at_a_registry({})

    def test_a_lock_that_does_not_fit(self):
        file = self.source / "package.json"
        wanted = json.loads(file.read_text())
        wanted["dependencies"]["copc"] = "0.0.7"
        file.write_text(json.dumps(wanted))
        version = {"name": "copc", "version": "0.0.7", "dist": {"tarball": "http://127.0.0.1/copc.tgz"}}
        words = self.fails_at_a_registry({"name": "copc", "dist-tags": {}, "versions": {"0.0.7": version}})
        self.assertIn("package-lock.json", words)

    def fails_at_a_registry(self, answer):
        """The words, with a registry that knows one package or none."""
        class Registry(http.server.BaseHTTPRequestHandler):
            def do_GET(self):
                if self.path != "/" + answer.get("name", ""):
                    self.send_error(404)
                    return
                self.send_response(200)
                self.end_headers()
                self.wfile.write(json.dumps(answer).encode())

            def log_message(self, *_):
                pass

        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Registry) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            words = self.install(server.server_port)
            server.shutdown()
        self.assertNotIn("Skipped:", words)
        self.assertIn("npm ci failed", words)
        return words


if __name__ == "__main__":
    unittest.main()
