#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Damages files of every format that the command line reads, and counts what it does with them.

damage.py CROFTON [--variants N] [--first N] [--seconds S] [--megabytes M] [--jobs J] [--seed K] [--keep FOLDER]

Each variant is a sound file with bits flipped, bytes cut out, copied or replaced, its end cut off, or its numbers
replaced by ones that are too large, negative, or none. Right is any exit status of 0, 1 or 2. A crash (a signal,
another status, or a sanitizer's report), a run longer than S seconds, and one of more than M megabytes are failures, kept
in FOLDER. Exits with 1 if there is any. The same seed makes the same files; --first goes on where a run was stopped.

Each file has a process of its own, in which main begins. Loading the program takes longer than a damaged file does, so
these processes are copies of one that has just been loaded.
"""
import argparse
import concurrent.futures
import os
import pathlib
import queue
import random
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

SANITIZER_STATUS = 99
NUMBERS = [b"-1", b"0", b"4294967295", b"4294967296", b"18446744073709551615", b"1e308", b"1e-320", b"-0.0", b"NaN",
           b"1e999", b"2147483648", b"99999999999999999999", b'"x"', b"[]", b"{}", b"null", b"true"]


def png(width, height):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes((x * 7 + y * 3) % 256 for x in range(4 * width)) for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def textured_gltf():
    """A triangle with a sparse accessor, a texture, a material, a camera and a light; (text, binary)."""
    binary = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<6f", 0, 0, 1, 0, 0, 1)
    binary += struct.pack("<3H", 0, 1, 2) + b"\0\0" + struct.pack("<H", 1) + b"\0\0" + struct.pack("<3f", 2, 0, 0)
    image = png(8, 8)
    views = [(0, 36), (36, 24), (60, 6), (68, 2), (72, 12), (84, len(image))]
    binary += image
    text = ('{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,2]}],"nodes":[{"mesh":0,"children":[1],'
            '"translation":[1,2,3]},{"mesh":0,"rotation":[0,0,0.7071068,0.7071068],"scale":[2,1,1]},{"camera":0,'
            '"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1],"mesh":0}],"cameras":[{"type":"perspective","perspective":'
            '{"yfov":1,"znear":0.1}}],"meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},'
            '"indices":2,"material":0,"mode":4}]}],"materials":[{"doubleSided":true,"emissiveFactor":[1,1,1],'
            '"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0.25,1],"baseColorTexture":{"index":0}},"extensions":'
            '{"KHR_materials_emissive_strength":{"emissiveStrength":2}}}],"textures":[{"source":0}],"images":'
            '[{"bufferView":5,"mimeType":"image/png"}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,'
            '"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":3,"componentType":5123},"values":'
            '{"bufferView":4}}},{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},{"bufferView":2,'
            '"componentType":5123,"count":3,"type":"SCALAR"}],"bufferViews":[' +
            ",".join('{"buffer":0,"byteOffset":%d,"byteLength":%d}' % view for view in views) +
            '],"buffers":[{"byteLength":%d%s}]}')
    return text, binary


def glb(text, binary):
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    return (b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)) + struct.pack("<I", len(text)) + b"JSON" +
            text + struct.pack("<I", len(binary)) + b"BIN\0" + binary)


def wad():
    """A room with a column."""
    corners = [(0, 0), (0, 256), (256, 256), (256, 0), (96, 96), (160, 96), (160, 160), (96, 160)]
    lines = b"".join(struct.pack("<HH6xHH", 4 * r + k, 4 * r + (k + 1) % 4, 4 * r + k, 0xFFFF)
                     for r in range(2) for k in range(4))
    lumps = [(b"E1M1", b""), (b"LINEDEFS", lines), (b"SIDEDEFS", (b"\0" * 4 + b"-\0\0\0\0\0\0\0" * 2 + b"BRICK1\0\0" +
             b"\0\0") * 8), (b"VERTEXES", b"".join(struct.pack("<hh", *c) for c in corners)),
             (b"SECTORS", struct.pack("<hh8s8sh4x", 0, 128, b"FLOOR4_8", b"CEIL3_5", 160))]
    body, directory = b"", b""
    for name, data in lumps:
        directory += struct.pack("<II8s", 12 + len(body), len(data), name)
        body += data
    return b"PWAD" + struct.pack("<II", len(lumps), 12 + len(body)) + body + directory


def sound_files(crofton, folder):
    """[(name, contents, arguments of crofton with {} for the file)]"""
    text, binary = textured_gltf()
    (folder / "beside.bin").write_bytes(binary)
    (folder / "beside.mtl").write_bytes(b"newmtl m\nKd 0.5 0.5 0.5\nKe 1 1 1\nmap_Kd beside.png\n")
    (folder / "beside.png").write_bytes(png(8, 8))
    frames, triangulate = ["frames", "{}", "--no-draw", "--frames", "1"], ["triangulate", "{}", "--work-limit", "1"]
    obj = (b"mtllib beside.mtl\no a\nv 0 0 0\nv 1 0 0 1 0 1\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl m\n"
           b"f 1/1/1 2/2/1 3//1\nf -1 -2 -3\ng b\nf 1 2 3 4\n")
    polygons = b"P star 2\n5 0 0 9 1 8 9 4 3 1 8\n4 2 2 3 2 3 3 2 3\nP square 1\n4 0 0 1 0 1 1 0 1\n"
    geojson = (b'{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"a"},"geometry":'
               b'{"type":"MultiPolygon","coordinates":[[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[2,1],[2,2],[1,1]]]]}}]}')
    camera = b'{"cameras":[{"position":[0,2,9],"forward":[0,0,-1],"up":[0,1,0],"fov_y":1,"near":0.1,"far":"infinity"}]}'
    in_glb = glb((text % (len(binary), "")).encode(), binary)
    in_text = (text % (len(binary), ',"uri":"beside.bin"')).encode()
    out = "{}.out.glb"  # not /dev/null: the name must end so, or no file is read
    files = [("a.glb", in_glb, frames), ("b.glb", in_glb, triangulate + ["--out", out]),
             ("a.gltf", in_text, frames), ("b.gltf", in_text, triangulate + ["--out", out]),
             ("a.obj", obj, frames), ("b.obj", obj, triangulate + ["--out", out]), ("c.obj", obj, ["fit", "{}"]),
             ("a.wad", wad(), frames), ("b.wad", wad(), triangulate), ("a.poly", polygons, triangulate),
             ("a.geojson", geojson, triangulate), ("a.json", b"[[[0,0],[9,0],[9,9],[0,9]],[[1,1],[2,1],[2,2]]]", triangulate),
             ("camera.json", camera, ["frames", str(folder / "tiny.obj"), "--no-draw", "--camera", "{}"]),
             ("image.glb", in_glb, frames)]
    (folder / "tiny.obj").write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    baked = folder / "tiny.crofton"
    subprocess.run([crofton, "bake", str(folder / "tiny.obj"), "-o", str(baked)], check=True, stdout=subprocess.DEVNULL)
    files.append(("a.crofton", baked.read_bytes(), ["bake", "{}"]))
    return files


def damaged(contents, name, chance):
    data = bytearray(contents)
    if name == "image.glb":  # within the picture only
        begin = data.find(b"\x89PNG")
        for _ in range(chance.randint(1, 6)):
            data[chance.randrange(begin, len(data))] = chance.randrange(256)
        return bytes(data)
    for _ in range(chance.choice([1, 1, 2, 4])):
        way, size = chance.randrange(7), max(1, len(data))
        at = chance.randrange(size)
        if way == 0 and data:
            data[at] ^= 1 << chance.randrange(8)
        elif way == 1 and data:
            data[at] = chance.randrange(256)
        elif way == 2:
            del data[at:at + chance.randint(1, 40)]
        elif way == 3:
            data[at:at] = data[chance.randrange(size):][:chance.randint(1, 400)]
        elif way == 4:
            del data[at:]
        elif way == 5 and len(data) > 8:
            data[at:at + 4] = struct.pack("<I", chance.choice([0, 1, 0x7FFFFFFF, 0xFFFFFFFF, len(data), 1 << 28]))
        else:
            spots = list(re.finditer(rb"-?\d+(\.\d+)?", bytes(data)))
            if spots:
                spot = chance.choice(spots)
                data[spot.start():spot.end()] = chance.choice(NUMBERS)
    return bytes(data)


class Server:
    """The program, loaded once: each run is a copy of that process, in which main begins (fork_server.c)."""

    def __init__(self, options, library, errors):
        to_child, self.tasks = os.pipe()
        self.answers, from_child = os.pipe()
        self.errors = errors

        def descriptors():
            high = [os.dup2(d, number) for d, number in ((to_child, 100), (from_child, 101))]
            os.dup2(high[0], 3)
            os.dup2(high[1], 4)

        # A sanitizer's status would be 1 by itself, which is that of a refused file.
        sanitizer = f"exitcode={SANITIZER_STATUS}:abort_on_error=0"
        environment = dict(os.environ, LD_PRELOAD=str(library), CROFTON_SERVER_SECONDS=str(max(1, round(options.seconds))))
        for name in ("ASAN_OPTIONS", "UBSAN_OPTIONS"):
            environment[name] = ":".join(filter(None, [os.environ.get(name), sanitizer]))
        self.process = subprocess.Popen([options.crofton], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, env=environment,
                                        close_fds=False, preexec_fn=descriptors)
        os.close(to_child)
        os.close(from_child)

    def run(self, arguments):
        """(wait status, kilobytes at most, what it said on standard error)"""
        os.write(self.tasks, ("\t".join([str(self.errors), *arguments]) + "\n").encode())
        answer = b""
        while not answer.endswith(b"\n"):
            more = os.read(self.answers, 100)
            if not more:
                sys.exit(f"damage.py: {self.process.args[0]} ended by itself")
            answer += more
        status, memory = map(int, answer.split())
        with open(self.errors, "rb") as said:
            said.seek(max(0, os.path.getsize(self.errors) - 2000))
            return status, memory, said.read().decode(errors="replace")


def try_one(options, servers, number, name, contents, arguments, folder):
    """(None or what failed, exit status, kilobytes)"""
    chance = random.Random(options.seed * 1_000_003 + number)
    path = folder / f"{number}_{name}"
    path.write_bytes(damaged(contents, name, chance))
    arguments = [a.replace("{}", str(path)) for a in arguments]
    server = servers.get()
    status, memory, said = server.run(arguments)
    servers.put(server)
    code = os.waitstatus_to_exitcode(status)
    failure = None
    if code == -signal.SIGALRM:
        failure = "hang"
    elif code not in (0, 1, 2) or "Sanitizer" in said or "runtime error:" in said:
        failure = "crash"
    elif memory > options.megabytes * 1024:
        failure = "memory"
    if failure and options.keep:
        os.replace(path, pathlib.Path(options.keep) / path.name)
    for left in (path, path.with_name(path.name + ".out.glb")):
        left.unlink(missing_ok=True)
    return failure and f"{failure}: status {code}, {memory >> 10} MB: {' '.join(arguments)}\n{said}", code, memory


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("crofton")
    parser.add_argument("--variants", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--megabytes", type=int, default=1024)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        library = folder / "fork_server.so"
        subprocess.run(["cc", "-O1", "-shared", "-fPIC", pathlib.Path(__file__).with_name("fork_server.c"), "-o", library, "-ldl"],
                       check=True)
        files = sound_files(options.crofton, folder)
        servers = queue.Queue()
        for job in range(options.jobs):
            servers.put(Server(options, library, folder / f"errors_{job}"))
        for name, contents, arguments in files:  # a command line that is refused reads nothing
            server = servers.get()
            (folder / name).write_bytes(contents)
            status, _, said = server.run([a.replace("{}", str(folder / name)) for a in arguments])
            servers.put(server)
            if status:
                sys.exit(f"damage.py: the sound file {name} is not taken: {said}")
        failures, codes, most, begin = [], {}, 0, time.monotonic()
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            def task(number):
                return try_one(options, servers, number, *files[number % len(files)], folder)
            for done, (failure, code, memory) in enumerate(pool.map(task, range(options.first, options.variants)), 1):
                most = max(most, memory)
                codes[code] = codes.get(code, 0) + 1
                if failure:
                    failures.append(failure)
                    print(failure, file=sys.stderr)
                if done % 1000 == 0:
                    print(f"{options.first + done} variants, {done / (time.monotonic() - begin):.0f} a second, "
                          f"{len(failures)} failures", flush=True)
    kinds = {kind: sum(f.startswith(kind) for f in failures) for kind in ("crash", "hang", "memory")}
    print(f"{options.variants - options.first} damaged files of {len(files)} kinds, of which {codes.get(0, 0)} were taken and "
          f"{codes.get(1, 0) + codes.get(2, 0)} refused: {kinds['crash']} crashes, {kinds['hang']} hangs, "
          f"{kinds['memory']} above {options.megabytes} MB; the most was {most >> 10} MB; "
          f"{(options.variants - options.first) / (time.monotonic() - begin):.0f} a second")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
