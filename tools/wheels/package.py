# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What is done to a wheel after it is built: licences and bill of materials in, the platform's name, one order of bytes."""

import base64
import csv
import hashlib
import io
import json
import struct
import time
import uuid
import zipfile
import zlib
from urllib.parse import quote

from toolchain import fail, run, source_time


def read_wheel(path):
    """Content and mode of every file, by name."""
    with zipfile.ZipFile(path) as archive:
        return {entry.filename: (archive.read(entry), entry.external_attr >> 16)
                for entry in archive.infolist() if not entry.is_dir()}


def record(files, name):
    """The text of RECORD, which states the hash of every file but itself."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    for file in sorted(files):
        if file != name:
            digest = base64.urlsafe_b64encode(hashlib.sha256(files[file][0]).digest()).rstrip(b"=").decode()
            rows.writerow([file, f"sha256={digest}", len(files[file][0])])
    rows.writerow([name, "", ""])
    return text.getvalue().encode()


def deflated(content):
    """The stream of deflate without zlib's frame, by Zopfli: 4 % smaller than the best of zlib."""
    from zopfli.zlib import compress  # of the tools, which are there when a wheel is complete
    return compress(content, numiterations=5)[2:-4]


def write_archive(entries, path, date):
    """A ZIP archive of files that are compressed already, as (name, mode, content)."""
    moment = ((date[0] - 1980) << 25 | date[1] << 21 | date[2] << 16 | date[3] << 11 | date[4] << 5 | date[5] // 2)
    directory = b""
    count = 0
    with open(path, "wb") as out:
        for name, mode, content in entries:
            stream = deflated(content)
            word = name.encode()
            # Version 2.0, names in UTF-8, deflate.
            common = struct.pack("<HHHIIIIHH", 20, 0x800, 8, moment, zlib.crc32(content), len(stream), len(content), len(word), 0)
            directory += struct.pack("<IH", 0x02014B50, 3 << 8 | 20) + common
            directory += struct.pack("<HHHII", 0, 0, 0, mode << 16, out.tell()) + word
            out.write(struct.pack("<I", 0x04034B50) + common + word + stream)
            count += 1
        begin = out.tell()
        out.write(directory + struct.pack("<IHHHHIIH", 0x06054B50, 0, 0, count, count, len(directory), begin, 0))


def write_wheel(files, path):
    """A wheel that depends on nothing but its files and the time of the last commit."""
    info = next(name.split("/")[0] for name in files if name.endswith(".dist-info/WHEEL"))
    files = {**files, f"{info}/RECORD": (record(files, f"{info}/RECORD"), 0o644)}
    date = time.gmtime(source_time())[:6]
    # The metadata stand at the end, as the standard recommends.
    names = sorted(files, key=lambda name: (name.startswith(info), name))
    write_archive([(name, 0o100755 if files[name][1] & 0o100 else 0o100644, files[name][0]) for name in names], path, date)
    with zipfile.ZipFile(path) as archive:
        if [archive.read(name) for name in names] != [files[name][0] for name in names]:
            fail(f"{path}: is not what was put into it")
    return path


def component(name, version, purl, licence):
    return {"type": "library", "bom-ref": purl, "name": name, "version": version, "purl": purl,
            "licenses": [{"expression": licence}], "properties": [{"name": "posemix:linked", "value": "statically"}]}


def debian_component(library):
    purl = f"pkg:deb/debian/{library.package}@{quote(library.version, safe=':.~-')}?arch={library.kind}"
    return component(library.name, library.version, purl, library.licence)


def bill_of_materials(version, libraries, others):
    """CycloneDX 1.6 of what is in the compiled module: the libraries, and what PyPI's packages put into it."""
    components = [debian_component(library) for library in libraries]
    components += [component(name, number, f"pkg:pypi/{name}@{number}", licence) for name, number, licence in others]
    seed = json.dumps([version, components])
    stamp = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(source_time()))
    return {
        "bomFormat": "CycloneDX", "specVersion": "1.6", "version": 1,
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, 'posemix ' + seed)}",
        "metadata": {
            "timestamp": stamp,
            "component": {"type": "library", "bom-ref": "posemix", "name": "posemix", "version": version,
                          "purl": f"pkg:pypi/posemix@{version}", "licenses": [{"license": {"id": "MIT"}}]}},
        "components": components,
        "dependencies": [{"ref": "posemix", "dependsOn": [part["purl"] for part in components]}],
    }


def complete(wheel, version, libraries, others, notices, out):
    """Add licences and bill of materials; returns the new wheel."""
    files = read_wheel(wheel)
    info = next(name.split("/")[0] for name in files if name.endswith(".dist-info/WHEEL"))
    for library in libraries:
        files[f"{info}/licenses/{library.name}.txt"] = (library.notice_text(), 0o644)
    for name, text in notices.items():
        files[f"{info}/licenses/{name}.txt"] = (text, 0o644)
    bill = json.dumps(bill_of_materials(version, libraries, others), indent=1) + "\n"
    files[f"{info}/sboms/posemix.cdx.json"] = (bill.encode(), 0o644)
    return write_wheel(files, out / wheel.name)


# auditwheel takes the names of platforms of the machine it runs on, and no other: it is told which one that is.
AUDITWHEEL = """import platform, sys
machine = sys.argv.pop(1)
platform.machine = lambda: machine
from auditwheel.main import main
sys.exit(main())"""


def repair(wheel, toolchain, glibc):
    """auditwheel checks what the module needs of the system, and names the platform; nothing is to be copied in."""
    platform = f"manylinux_{glibc.replace('.', '_')}_{toolchain.machine}"
    repaired = toolchain.work / "repaired"
    repaired.mkdir(exist_ok=True)
    for old in repaired.glob("*.whl"):
        old.unlink()
    run(toolchain.tools / "bin/python", "-c", AUDITWHEEL, toolchain.machine, "repair", "--plat", platform, "--only-plat",
        "--wheel-dir", repaired, wheel, log=toolchain.work / "repair.log",
        env={**toolchain.environment, "PATH": f"{toolchain.tools}/bin:/usr/bin:/bin"})
    return next(repaired.glob("*.whl"))
