"""From starting the daemon to READY, beside another process that starts ONNX Runtime alone and runs
the same network once."""
import statistics
import time

from bare import Bare
from measure import calmest, waited
from selectord import Selectord

CANDIDATES = 8


def run(context):
    """All of the group."""
    name = "efficientnet_lite0"
    manifest = context.scene.manifest(name)
    candidates = 2 if context.tiny else CANDIDATES
    options = ("--map", context.scene.map(manifest, candidates), "--backbone", manifest)
    rounds = [pair(context, manifest, options)
              for _ in range(2 if context.tiny else 15 if context.quick else 40)]
    used = calmest(rounds[1:], lambda both: both["waited"])  # the first one reads the files

    def median(value):
        return statistics.median(map(value, used))

    ready = [both["ready"] for both in used]
    timed = {"median": statistics.median(ready), "least": min(ready), "most": max(ready),
             "rounds": len(used), "waited": median(lambda both: both["waited"]),
             "peers": {"ONNX Runtime alone": {
                 "median": median(lambda both: both["bare"]),
                 "speedup": median(lambda both: both["bare"] / both["ready"])}}}
    yield (f"start {name}, K={candidates}", "ms", 1e3, timed,
           {"beyond_ms": 1e3 * median(lambda both: both["ready"] - both["bare"]),
            "processor_ms": 1e3 * median(lambda both: both["processor"]),
            "bare_processor_ms": 1e3 * median(lambda both: both["bare_processor"])})


def pair(context, manifest, options):
    """One start of each."""
    with Selectord(*options) as daemon:
        ready, processor = daemon.ready_after, sum(map(processor_seconds, daemon.pids))
        wait = sum(map(waited, daemon.pids)) / ready
    begin = time.monotonic()
    with Bare(context.build, manifest) as bare:
        bare.run(1)
        bare_after = time.monotonic() - begin
        return {"ready": ready, "bare": bare_after, "processor": processor,
                "bare_processor": processor_seconds(bare.pid),
                "waited": max(wait, waited(bare.pid) / bare_after)}


def processor_seconds(process):
    """Processor time of a process so far, that of threads which have ended included."""
    return time.clock_gettime(~process << 3 | 2)  # as clock_getcpuclockid() has it
