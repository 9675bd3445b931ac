#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The page of conceg report in a browser (headless Chromium): it draws without an error and asks nothing of any network; its charts
hold the document's numbers, another document changes them; names cannot break out; without WebGL it says so.
report_page.py BIN SOURCE"""
import html
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy as np

programs, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
if not browser:
    print("SKIPPED: no Chromium for the page of conceg report (Debian package chromium)")
    sys.exit(77)
for needed in ("conceg-report", "conceg-mesh", "conceg-simulate", "conceg-fit", "conceg-triangulate"):
    if not (programs / needed).exists():
        print(f"SKIPPED: this build has no {needed}")
        sys.exit(77)

checks, failures = 0, []


def expect(good, what):
    global checks
    checks += 1
    if not good:
        failures.append(what)
        print(f"FAILED: {what}", flush=True)


def conceg(*words, codes=(0,)):
    done = subprocess.run([programs / "conceg", *map(str, words)], stdout=subprocess.DEVNULL)
    if done.returncode not in codes:
        sys.exit(f"FAILED: conceg {' '.join(map(str, words))}: exit code {done.returncode}")


flat = "--disable-3d-apis"  # many times faster


class Seen:
    """What a browser made of a page: its elements as text, lines of the console, addresses that were asked for."""

    def __init__(self, page, work, *options):
        profile = tempfile.mkdtemp(dir=work)
        log = pathlib.Path(profile) / "net.json"
        done = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                               "--disable-background-networking", "--disable-component-update", "--no-first-run", "--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={profile}", f"--log-net-log={log}",
                               "--enable-logging=stderr", "--window-size=1100,800", "--virtual-time-budget=6000", *options, "--dump-dom", page.as_uri()],
                              capture_output=True, text=True, timeout=300)
        # What the reader sees: neither the data nor the code.
        self.dom = re.sub(r"<(script|style).*?</\1>", "", done.stdout, flags=re.S)
        self.console = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
        text = log.read_text() if log.exists() else ""
        # The browser's own requests (updates, dictionaries) go to its maker and are no part of the page.
        self.addresses = sorted({a for a in re.findall(r'"url":"((?:https?|wss?|ftp):[^"]*)"', text) if not re.match(r"https?://[^/]*\.?(google|googleapis|gstatic|gvt1)\.com", a)})
        shutil.rmtree(profile, ignore_errors=True)

    def attribute(self, name):
        found = re.search(rf'<html[^>]* data-{name}="([^"]*)"', self.dom)
        return found.group(1) if found else None

    def figure(self, name):
        """The text of one <figure>, '' when it is not there."""
        found = re.search(rf'<figure id="{name}".*?</figure>', self.dom, re.S)
        return found.group(0) if found else ""

    def labels(self, name):
        return re.findall(r'aria-label="([^"]*)"', self.figure(name))


def document(work):
    recipe = work / "small.yaml"
    recipe.write_text((source / "tests/pipe/small.yaml").read_text())
    conceg("run", recipe, "--until", "mesh", "--set", "mesh.h_um=0.6", "--set", "mesh.volume_step_um=0.5", "-q", "-o", work / "mesh.cgx")
    conceg("analyse", work / "mesh.cgx", "--points", 20000, "--composition=true", "--composition-cubes", 20, "--spectrum=true", "--compare=true", "-q", "-o", work / "analysed.cgx")
    conceg("simulate", work / "analysed.cgx", "--walkers", 200, "--step-ms", 0.02, "--directions", 6, "--times-ms", "1,5,10", "-q", "-o", work / "simulated.cgx")
    conceg("fit", work / "simulated.cgx", "--starts", 4, "-q", "-o", work / "fitted.cgx")
    conceg("analyse", work / "fitted.cgx", "--points", 10000, "-q", "-o", work / "twice.cgx")
    conceg("check", work / "twice.cgx", "-q", "-o", work / "full.cgx", codes=(0, 1))  # so coarse a mesh fails a gate


def numbers_of(labels, word):
    """The numbers after `word` in labels such as 'fragment 2 0.5'."""
    return [[float(n) for n in label[len(word):].split()] for label in labels if label.startswith(word + " ")]


def holds(page, file):
    """The charts' numbers are the document's."""
    with h5py.File(file) as doc:
        t = doc["/statistics/composition"]
        want = [[s, v] for s, v in zip(t["side"][:], t["fragment_volume"][:]) if v > 0]
        expect(want and np.allclose(numbers_of(page.labels("composition"), "fragment"), want, rtol=1e-12), "composition: the document's numbers")
        names = [n.decode() if isinstance(n, bytes) else n for n in doc["/signals/compartment"][:]]
        for x, name in enumerate(n for n in names if not n.startswith("type ")):  # those begin hidden
            want = [[b, s] for b, s in zip(doc["/signals/powder_b"][:], doc["/signals/powder"][x]) if s > 0]
            expect(np.allclose(numbers_of(page.labels("decay"), name), want, rtol=1e-12), f"signal {name}: the document's numbers")
        fits = doc["/statistics/sandi/f_neurite"][:]
        got = [float(label.split()[-1]) for label in page.labels("sandi-truth") if " f_neurite " in label]
        expect(np.allclose(got, fits, rtol=1e-12), f"SANDI: {got} against {fits}")
        summary = dict(zip((n.decode() if isinstance(n, bytes) else n for n in doc["/statistics/summary/name"][:]), doc["/statistics/summary/value"][:]))
        got = {label.split()[0]: float(label.split()[1]) for label in page.labels("fractions") if label.startswith("icvf")}
        expect(len(got) == 3 and all(np.isclose(got[n], summary[n], rtol=1e-12) for n in got), f"three fractions: {got}")
        tables = [name for name in doc["/statistics"]]
        for name in tables:
            expect(f"/statistics/{name}" in page.dom, f"/statistics/{name} is named on the page")


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        document(work)
        shutil.copy(work / "full.cgx", work / "made.cgx")
        with h5py.File(work / "full.cgx", "a") as doc:
            # Tables that no section knows are shown too.
            for name, rows in (("structure_planted", [0.25, -0.5, 1.5]), ("x_unheard_of", [3.5, 4.25, 5.0])):
                group = doc.create_group(f"/statistics/{name}")
                group.create_dataset("value", data=np.array(rows)).attrs["unit"] = "um"
        conceg("report", work / "full.cgx", "-q", "-o", work / "full.html")
        page = Seen(work / "full.html", work)
        figures = int(page.attribute("figures") or 0)
        expect(figures >= 20 and page.attribute("failed") == "0", f"{figures} figures, {page.attribute('failed')} failed")
        expect(not page.console, f"console: {page.console[:3]}")
        expect(not page.addresses, f"addresses: {page.addresses[:3]}")
        expect(page.dom.count("<svg") >= figures, "each figure has its chart")
        expect('data-drawn="yes"' in page.dom, "the 3-D view is drawn")
        expect(all(f'id="table-{name}"' in page.dom for name in ("structure_planted", "x_unheard_of")) and "3.5" in page.figure("table-x_unheard_of"), "tables that no section knows")
        holds(page, work / "full.cgx")

        # The eye that sees nothing must be able to see: an address and an error are planted.
        planted = work / "planted.html"
        text = (work / "full.html").read_text()
        planted.write_text(re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", text).replace("</body>", '<img src="http://planted.invalid/x.png"><script>console.error("planted")</script></body>'))
        seen = Seen(planted, work, flat)
        expect(any("planted.invalid" in a for a in seen.addresses) and any("planted" in line for line in seen.console), "a planted request and a planted error are seen")
        # The page itself forbids both.
        (work / "kept.html").write_text(text.replace("</body>", '<img src="http://planted.invalid/x.png"><script>document.documentElement.dataset.ran = "yes"</script></body>'))
        kept = Seen(work / "kept.html", work, flat)
        expect(not kept.addresses and kept.attribute("ran") is None and len(kept.console) >= 2, "the page's policy stops both")

        # The 3-D view knows which cell is where: asked at a grid of places, by a script that the policy would stop.
        asking = work / "asking.html"
        probe = ("""<script>setTimeout(() => {
            const scene = document.querySelector('.scene'), canvas = scene.querySelector('canvas'), box = canvas.getBoundingClientRect(), ids = new Set();
            let at = [0, 0];
            for (let x = 5; x < scene.clientWidth; x += 25) for (let y = 5; y < scene.clientHeight; y += 25) { const id = scene.pick(x, y); ids.add(id); if (id !== null) at = [x, y]; }
            for (const type of ['pointerdown', 'pointerup']) canvas.dispatchEvent(new PointerEvent(type, {clientX: box.x + at[0], clientY: box.y + at[1], pointerId: 1, bubbles: true}));
            document.documentElement.dataset.ids = [...ids].filter(i => i !== null).join(' ');
            document.documentElement.dataset.empty = ids.has(null);
        }, 3000)</script></body>""")
        asking.write_text(re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", text).replace("</body>", probe))
        found = Seen(asking, work)
        with h5py.File(work / "full.cgx") as doc:
            cells = len(doc["/cells/id"])
        ids = {int(i) for i in (found.attribute("ids") or "").split()}
        expect(len(ids) > cells / 2 and ids <= set(range(cells)) and found.attribute("empty") == "true", f"cells under the pointer: {sorted(ids)} of {cells}")

        card = re.sub("<[^>]*>", " ", (re.search(r'<div class="cellcard".*?</div>', found.dom, re.S) or [""])[0])
        expect(re.search(r"cell +\d+ .*soma radius .*µm", card, re.S) and "object" not in card, f"the card of a cell: {card[:200]}")

        # What the page says of its making makes the document again.
        again = work / "again"
        again.mkdir()
        blocks = [html.unescape(re.sub("<[^>]*>", "", block)) for block in re.findall(r'<div class="codehead">.*?<pre[^>]*>(.*?)</pre>', page.dom, re.S)]
        expect(len(blocks) == 2, f"commands and recipe: {len(blocks)}")
        (again / "again.sh").write_text(blocks[0].replace("ORIGINAL.cgx", str(work / "made.cgx")))
        (again / "recipe.yaml").write_text(blocks[1])
        done = subprocess.run(["bash", "again.sh"], cwd=again, env={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}, capture_output=True, text=True)
        expect(done.returncode == 0, f"the commands of the page make the document again: {done.stdout[-600:]} {done.stderr[-300:]}")

        # Another document, another chart; and names that would break out of a careless page.
        shutil.copy(work / "full.cgx", work / "changed.cgx")
        evil = '</script><script>document.title="out"</script><b>"\'&'
        with h5py.File(work / "changed.cgx", "a") as doc:
            doc["/statistics/composition/fragment_volume"][:] *= 1.5
            doc["/signals/powder"][:] *= 0.5
            doc["/statistics/sandi/f_neurite"][:] *= 0.5
            names = [n.decode() if isinstance(n, bytes) else n for n in doc["/types/name"][:]]
            width = len(evil) + 8
            for path in ("/types/name", "/statistics/type/type", "/statistics/bars/type"):
                unit = doc[path].attrs["unit"]
                values = [(v.decode() if isinstance(v, bytes) else v).replace(names[0], evil) for v in doc[path][:]]
                del doc[path]
                doc.create_dataset(path, data=np.array([v.encode() for v in values], dtype=f"S{width}")).attrs["unit"] = unit
        conceg("report", work / "changed.cgx", "-q", "-o", work / "changed.html")
        changed = Seen(work / "changed.html", work, flat)
        holds(changed, work / "changed.cgx")
        for name in ("composition", "decay", "sandi-truth"):
            shapes = [re.findall(r'<circle[^>]*>', p.figure(name)) for p in (page, changed)]
            expect(shapes[0] and shapes[0] != shapes[1], f"{name}: a changed document changes the chart")
        expect("<title>out" not in changed.dom and not changed.console and changed.attribute("failed") == "0", f"a hostile name stays a name: {changed.console[:2]}")
        expect("&lt;/script&gt;&lt;script&gt;" in changed.dom, "and is shown")

        # Parts that are missing are named with what makes them; no cells, no WebGL.
        conceg("strip", "statistics,signals,protocol,walkers,meshes,volumes", work / "full.cgx", "-q", "-o", work / "bare.cgx")
        conceg("report", work / "bare.cgx", "-q", "-o", work / "bare.html")
        bare = Seen(work / "bare.html", work)
        for words in ("No /signals: conceg simulate makes them", "No /statistics/sandi", "No /statistics/composition", "No /meshes: conceg mesh makes surfaces"):
            expect(words in bare.dom, f"bare: {words}")
        expect(bare.attribute("failed") == "0" and not bare.console and 'data-drawn="yes"' in bare.dom, f"bare: {bare.console[:2]}")
        blind = Seen(work / "full.html", work, flat)
        expect("No WebGL here" in blind.dom and blind.attribute("failed") == "0" and blind.figure("composition").count("<circle") > 3, "without WebGL the rest is there")
        print(f"{figures} figures, {len(ids)} cells picked")
    print(f"{checks} checks, {len(failures)} failed")
    return 1 if failures or not checks else 0


sys.exit(main())
