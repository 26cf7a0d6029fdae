# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs libFuzzer's program on targets, one after the other or side by side. README.md says more."""
import argparse
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

import kept_inputs
import samples
import seeds

SOURCE = samples.SOURCE
BUILD = os.path.join(SOURCE, "build/fuzz")
PROGRAM = os.path.join(BUILD, "tests/fuzz/sinew_fuzz")
# By the clock, which on a busy machine runs faster than the program.
SECONDS_AN_INPUT, MEGABYTES, MEGABYTES_AT_ONCE = 60, 2048, 1024
RUN_BY = {"UBSAN_OPTIONS": "print_stacktrace=1", "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=0"}
LONGEST = {"graph": 8192, "includes": 8192, "frame": 65536}


def stand_back():
    os.setsid()
    try:
        with open("/proc/self/autogroup", "w", encoding="ascii") as file:
            file.write("19")
    except OSError:
        pass
    os.nice(19)


def build():
    for words in (["release", "sinew_nodes", "sinew"], ["fuzz", "sinew_fuzz"]):
        subprocess.run([SOURCE + "/tools/build", *words], check=True, preexec_fn=stand_back)


def names():
    ended = subprocess.run([PROGRAM], env={"SINEW_FUZZ_TARGET": ""}, stderr=subprocess.PIPE, text=True, check=False)
    return ended.stderr.split(":", 1)[1].split()


class Fuzzing:
    """One target at work, until it has had its seconds of the processor: a busy machine tries no less than an idle one."""

    def __init__(self, target, begin_with, seconds, found):
        self.target, self.seconds, self.used, self.code = target, seconds, 0.0, None
        folder = os.path.join(BUILD, "corpus", target)
        self.found = os.path.join(found, target)
        grown, given = folder + "/grown", folder + "/seeds"
        for path in (grown, given, self.found):
            os.makedirs(path, exist_ok=True)
        for i, seed in enumerate(begin_with + kept_inputs.of(target)):
            with open(f"{given}/{i}", "wb") as file:
                file.write(seed)
        words = seeds.words_of(begin_with)
        with open(folder + "/words", "w", encoding="ascii") as file:
            file.write(words)
        dictionary = [f"-dict={folder}/words"] if words else []  # libFuzzer takes no empty one
        self.before = set(os.listdir(self.found))
        self.log = folder + "/log"
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(
                [PROGRAM, grown, given, self.found, "-handle_usr1=1", f"-timeout={SECONDS_AN_INPUT}",
                 f"-rss_limit_mb={MEGABYTES}", f"-malloc_limit_mb={MEGABYTES_AT_ONCE}",
                 f"-max_len={LONGEST.get(target, 4096)}", f"-artifact_prefix={self.found}/", *dictionary,
                 "-use_value_profile=1", "-print_final_stats=1"],
                stdout=log, stderr=log, stdin=subprocess.DEVNULL, preexec_fn=stand_back,
                env={**os.environ, **RUN_BY, "SINEW_FUZZ_TARGET": target})

    def has_ended(self):
        pid, status, usage = os.wait4(self.process.pid, os.WNOHANG)
        if pid:
            self.used, self.code = usage.ru_utime + usage.ru_stime, os.waitstatus_to_exitcode(status)
            self.process.returncode = self.code
            return True
        with open(f"/proc/{self.process.pid}/stat", encoding="ascii") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        if (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK") >= self.seconds:
            self.process.send_signal(signal.SIGUSR1)  # libFuzzer ends in good order
        return False

    def tell(self):
        """True if there is a finding."""
        with open(self.log, encoding="utf-8", errors="replace") as file:
            text = file.read()
        inputs = re.findall(r"stat::number_of_executed_units: (\d+)", text) or re.findall(r"#(\d+)", text) or ["0"]
        edges = re.findall(r" cov: (\d+)", text) or ["0"]
        new = sorted(set(os.listdir(self.found)) - self.before)
        if not os.listdir(self.found):
            os.rmdir(self.found)
        print(f"{self.target}: {inputs[-1]} inputs in {self.used / 60:.1f} min of the processor, {edges[-1]} edges, "
              f"{len(new)} findings, exit code {self.code}", flush=True)
        for name in new:
            why = re.search(r"(ERROR: .*|.*runtime error: .*|.*what\(\): .*)", text)
            print(f"    {self.found}/{name}\n    {why.group(1) if why else 'see ' + self.log}", flush=True)
        return bool(new) or self.code != 0


def keep(target):
    """Of all that has led further, as little as reaches the same lines goes into the tree."""
    folder = os.path.join(BUILD, "corpus", target)
    with tempfile.TemporaryDirectory() as least:
        subprocess.run([PROGRAM, "-set_cover_merge=1", f"-max_len={LONGEST.get(target, 4096)}", least, folder + "/seeds",
                        folder + "/grown"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                       preexec_fn=stand_back, env={**os.environ, **RUN_BY, "SINEW_FUZZ_TARGET": target})
        inputs = []
        for name in sorted(os.listdir(least)):
            with open(os.path.join(least, name), "rb") as file:
                inputs.append(file.read())
    kept_inputs.write(target, inputs)
    print(f"{target}: {len(inputs)} inputs of {sum(map(len, inputs))} bytes are kept", flush=True)


def main(words):
    parser = argparse.ArgumentParser(prog="tests/fuzz/run libfuzzer", description=__doc__)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="default: all")
    parser.add_argument("--seconds", type=int, default=60, help="of the processor for each target; default: 60")
    parser.add_argument("--jobs", type=int, default=1, help="targets at work at once; default: 1")
    parser.add_argument("--found", default=os.path.join(samples.HERE, "found"), help="where findings go; default: %(default)s")
    parser.add_argument("--keep", action="store_true", help="what leads furthest goes into tests/fuzz/corpus at the end")
    parser.add_argument("--no-build", action="store_true", help="the program is there and right")
    given = parser.parse_args(words)
    if not given.no_build:
        build()
    known = names()
    unknown = [t for t in given.targets if t not in known]
    if unknown:
        parser.error(f"no target {', '.join(unknown)}; there are {', '.join(known)}")
    begin_with = seeds.all_seeds(os.path.join(SOURCE, "build/release/tools/sinew"))
    todo, at_work, wrong = list(given.targets or known), [], False
    while todo or at_work:
        while todo and len(at_work) < given.jobs:
            target = todo.pop(0)
            at_work.append(Fuzzing(target, begin_with.get(target, [b""]), given.seconds, given.found))
        time.sleep(0.5)
        for one in [f for f in at_work if f.has_ended()]:
            at_work.remove(one)
            wrong = one.tell() or wrong
            if given.keep:
                keep(one.target)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
