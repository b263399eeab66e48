"""`parsim bench`: the machine's own account of what parsim does on it."""

import json
import sys
from collections.abc import Iterator
from typing import Any

from parsim.bench import model
from parsim.bench.account import SUPPORTS, everything


def bench_machine(as_json: bool, with_model: bool) -> int:
    """Measure and print: the ratios first, or everything as JSON; with the cost model if wanted. Returns 0."""

    def tell(line):
        print(f"... {line}", file=sys.stderr, flush=True)

    found = model.fitted(tell) if with_model else everything(tell)
    if as_json:
        print(json.dumps(found, indent=1))
    else:
        print(*(model.lines(found) if with_model else lines(found)), sep="\n")
    return 0


def lines(found: dict[str, Any]) -> Iterator[str]:
    """The account in words: ratios, then rates, shares of the step, sweeps, sizes."""
    yield from _ratios(found)
    yield ""
    yield f"{'active particle-steps/s/core':<32}" + "".join(f"{f'support {s}':>14}" for s in SUPPORTS)
    for name, row in found["cases"].items():
        yield f"  {name:<30}" + "".join(f"{row[str(s)]['rate']:>14,.0f}" for s in SUPPORTS)
    yield ""
    yield from _shares(found["cases"], str(SUPPORTS[0]))
    yield ""
    yield from _sweeps(found["kernels"])
    yield ""
    yield f"{'water':>12}{'active':>12}{'rate':>12}"
    for size in found["sizes"]:
        yield f"{size['fluid']:>12,}{size['active']:>12,}{size['rate']:>12,.0f}"
    yield ""
    yield "machine: " + ", ".join(f"{key} {text}" for key, text in found["machine"].items())


def _ratios(found):
    heap = found["heap"]
    slowest, fastest = (pick(size["rate"] for size in found["sizes"]) for pick in (min, max))
    balance = found["balance"]
    for told, value in (
        ("two ranks against one", f"{found['ranks_efficiency']:.3f} of twice the speed"),
        ("two threads against one", f"{found['threads_efficiency']:.3f} of twice the speed"),
        (
            "most uneven work, dam break",
            ", ".join(f"{row['most']:.1%} on {ranks} ranks (mean {row['mean']:.1%})" for ranks, row in balance.items()),
        ),
        ("slowest over fastest size", f"{slowest / fastest:.3f}"),
        (
            "memory",
            f"{found['bytes_per_particle']:.0f} bytes per active particle, lists included; at most "
            f"{found['peak_bytes_per_particle']:.0f}",
        ),
        ("start to first step", f"{found['start_warm_s']:.1f} s, with empty caches {found['start_cold_s']:.0f} s"),
        ("slower sweep", f"{found['kernel_ns_per_pair']:.2f} ns per true pair"),
        (
            "a heap of balls",
            f"{heap['rate']:,.0f} bodies x sub-steps/s; {heap['bodies']:,} with {heap['touching']:.1f} contacts",
        ),
    ):
        yield f"{told:<32}{value}"


def _shares(cases, support):
    names = list(dict.fromkeys(name for row in cases.values() for name in row[support]["phases"]))
    yield f"{'share of the step, %':<32}" + "".join(f"{name:>17}" for name in cases)
    for name in names:
        shares = [row[support]["phases"].get(name, 0.0) / row[support]["wall_s"] for row in cases.values()]
        yield f"  {name:<30}" + "".join(f"{100 * share:>17.1f}" for share in shares)


def _sweeps(kernels):
    yield f"{'ns per true pair':<32}" + "".join(f"{f'support {s}':>14}" for s in kernels)
    for name in next(iter(kernels.values())):
        yield f"  {name.replace('_', ' '):<30}" + "".join(f"{row[name]:>14.2f}" for row in kernels.values())
