"""Compiles the kernels to LLVM code, once for all platforms, and that to the object code of one.

numba writes each entry as LLVM code, not optimized, in a process of its own (`python -m fmu_src.native.export < request.json`): the
just-in-time compiler elsewhere is not disturbed, and entries are compiled side by side.  They are freed of reference counts (every array
is the C layer's), optimized there, and linked as one module, which keeps what they have in common once.  Numba takes the oldest x86-64
processor and no vectors: what it writes then knows its platform by a name and a layout of data alone, which are another's in the end.
"""

from __future__ import annotations

import gc
import json
import os
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from cable_model.entries import (
    ABSENT,
    ADVANCE,
    COLUMNS,
    EITHER,
    END,
    EXTERNAL,
    NODES,
    PATH,
    PRESENT,
    RELEASED,
    ROWS,
    SHAPE,
    SIZES,
    START,
    STEP,
    TABLES,
    WORK,
    Variant,
)  # fmt: skip
from fmu_src.native.reshape import RESHAPE
from fmu_src.native.targets import LINUX, Target

ROOT = Path(__file__).resolve().parents[2]
_PROCESSES = ThreadPoolExecutor(os.cpu_count())  # waits for so many at a time, of all exports together
LONGEST = 1800  # s, of an export; two variants take a few minutes
ENVIRONMENT = {
    "NUMBA_CPU_NAME": "x86-64",
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_OPT": "0",
    "NUMBA_LOOP_VECTORIZE": "0",
    "NUMBA_DISABLE_JIT": "0",
    "PYTHONHASHSEED": "0",
}
_ROWS = "".join(f"const double *{name}, int64_t n_{name}, " for name in TABLES)
ENTRY = f"""
int32_t {{name}}(int64_t *status, void **error, int64_t what, double time, double step, int64_t order, const double *inputs,
               const double *numbers, const double *present,
               {_ROWS}
               double *state, int64_t state_size, double *work, int64_t work_size, double *outputs);
"""


class ExportError(RuntimeError):
    """The kernels could not be compiled to object code; the text says why."""


def _parts(variant: Variant) -> Any:
    """A jitted function of (present, whole, held, *tables) that makes the parts of a variant.

    `whole` 0: of a cable that has parted; `held` 1: while its lower end is not let go.
    """
    from numba import njit

    from cable_model.effects import GOING, Parts

    @njit
    def either(asked, part):
        if asked != 0.0:
            return part
        return None

    made = []
    for k, name in enumerate(Parts._fields):
        part = name if name in TABLES else "True"
        there = f"present[{k}]{' * whole' if name in GOING else ''}{' + held' if name == 'anchor' else ''}"
        made.append({ABSENT: "None", EITHER: f"either({there}, {part})"}.get(variant[name], part))
    # numba wants the members of a named tuple spelled out
    return njit(eval(f"lambda present, whole, held, {', '.join(TABLES)}: Parts({', '.join(made)})", {"Parts": Parts, "either": either}))


def _start(kernels: Any, released: int) -> Any:
    """A jitted function of (parts, held, let_go, numbers, time, state, work) that finds the start: `held` are the parts until it is let go.

    `released`: whether it is let go, ABSENT, PRESENT or, by the number `let_go`, EITHER.
    """
    from cable_model.kernels import header
    from fmu_src.native import presence

    initialize, settle, release, ok = kernels.initialize, getattr(kernels, "settle", None), getattr(kernels, "release", None), header.OK

    def start(parts, held, let_go, numbers, time, state, work):
        return initialize(parts, numbers, time, state, work)

    def drop(parts, held, let_go, numbers, time, state, work):
        status = settle(held, numbers, time, state, work)
        if status == ok:
            status = release(parts, numbers, time, state, work)
        return status

    def either(parts, held, let_go, numbers, time, state, work):
        if let_go != 0.0:
            return drop(parts, held, let_go, numbers, time, state, work)
        return initialize(parts, numbers, time, state, work)

    if released == EITHER:
        drop = presence.kernel(drop)
    return presence.kernel({ABSENT: start, PRESENT: drop, EITHER: either}[released])


def _entry(kernels: Any, variant: Variant) -> Any:
    """The calls of just_in_time.JustInTime, from plain pointers.

    SIZES writes those of state and work to `out`.  ADVANCE finds the inputs at the end of its step in work[END:WORK].  All others
    write the outputs there; NODES and SHAPE after them `order` points, 4 numbers each: the nodes, or evenly along the cable.
    """
    from numba import carray

    from cable_model.calls import FASTEST_END, TOO_FAST
    from cable_model.effects import Parts
    from cable_model.kernels import ends, exchange, header, host, host_trials, instants, ringing, watch
    from cable_model.kernels.parting import is_whole
    from cable_model.kernels.path import fastest_end
    from cable_model.signals import INPUTS
    from cable_model.signals import OUTPUTS as NAMES

    released = variant.get(RELEASED, ABSENT)
    held_variant = variant if released == EITHER else {**variant, "anchor": PRESENT}  # of the same types, which are compiled once
    parts_now, held_then, start = _parts(variant), _parts(held_variant), _start(kernels, released)
    advance, write_outputs = kernels.advance, kernels.outputs
    state_size, work_size, points = kernels.state_size, kernels.work_size, kernels.points
    ok, again, parting = header.OK, host_trials.AGAIN, header.PARTING
    n_inputs, n_parts, n_outputs = len(INPUTS), len(Parts._fields), len(NAMES)
    k_driven = Parts._fields.index("driven")
    of_current, of_history, of_waves, of_curve, of_relief, of_pieces, of_bodies = TABLES.values()

    def entry(
        what, time, step, order, x, p, on, levels, n_levels, history, n_history, sea, n_sea, curve, n_rows, heights, n_heights, pieces,
        n_pieces, bodies, n_bodies, y, n_y, w, n_w, out,
    ):  # fmt: skip
        inputs = carray(x, (n_inputs,))
        numbers = carray(p, (1,))
        present = carray(on, (n_parts,))
        current, over_time, waves = (
            carray(levels, (n_levels, of_current)),
            carray(history, (n_history, of_history)),
            carray(sea, (of_waves, n_sea)),
        )
        laws, bed, sections, on_line = (
            carray(curve, (n_rows, of_curve)),
            carray(heights, (n_heights, of_relief)),
            carray(pieces, (n_pieces, of_pieces)),
            carray(bodies, (n_bodies, of_bodies)),
        )
        state = carray(y, (n_y,))
        whole = 1.0
        if what != SIZES and what != START and not is_whole(state):
            whole = 0.0
        parts = parts_now(present, whole, 0.0, current, over_time, waves, laws, bed, sections, on_line)
        outputs = carray(out, (n_outputs,))
        if what == SIZES:
            outputs[0] = state_size(parts, numbers)
            outputs[1] = WORK + work_size(parts, numbers) + host.room_size(numbers, state_size(parts, numbers), n_outputs)
            return ok
        work = carray(w, (n_w,))
        path = work[PATH:END].reshape((ROWS, COLUMNS))
        end = work[END:WORK]
        room = work[n_w - host.room_size(numbers, n_y, n_outputs) :]
        in_space = parts.space is not None
        steps, tells_points = what in (STEP, ADVANCE), what in (NODES, SHAPE)
        tries = what == STEP and room.shape[0] > 0
        if what == START or steps:
            refused = ends.refuse_inputs(numbers, time, state, inputs)
            if what == ADVANCE and refused == ok:
                refused = ends.refuse_inputs(numbers, time, state, end)
            if refused != ok:
                return refused
        if what == START:
            ends.start_ends(order, numbers, state, inputs)
        elif what == STEP:
            ringing.watch_ringing(numbers, state, inputs)
            instants.watch_instants(numbers, state)
            watch.watch_inputs(order, numbers, state, inputs, step)
            ends.follow_inputs(order, numbers, state, inputs, step, end, path)
        elif what == ADVANCE:
            ends.follow_ends(numbers, state, inputs, end, step, path)
        if tries:
            host_trials.begin_trials(in_space, numbers, time, step, state, outputs, inputs, room, path)
        status = again
        while status == again:  # kernels are called in one place each: they are compiled as often as they are called
            begins = room[host.TIME] if tries else time
            status = ok
            if what == START:
                let_go = on[n_parts] if released == EITHER else 0.0
                held = held_then(present, 1.0, let_go, current, over_time, waves, laws, bed, sections, on_line)
                status = start(parts, held, let_go, numbers, time, state, work[WORK:])
                watch.watch_start(state, inputs)
            elif steps:
                outputs[0] = fastest_end(path, step)
                status = TOO_FAST
                if outputs[0] <= FASTEST_END:
                    status = parting
                while status == parting:
                    whole = 1.0 if is_whole(state) else 0.0
                    parts = parts_now(present, whole, 0.0, current, over_time, waves, laws, bed, sections, on_line)
                    status = advance(parts, numbers, begins, step, path, state, work[WORK:])
            if status == ok:
                write_outputs(parts, numbers, state, work[WORK:], outputs)
                if what == START:
                    exchange.start_exchange(state, outputs)
                elif steps:
                    exchange.end_exchange(present[k_driven] != 0.0, state, step, outputs)
            if tries:
                status = host_trials.judge(in_space, numbers, status, state, outputs, room, path)
        if tells_points:
            table = carray(out, (n_outputs + 4 * order,))[n_outputs:].reshape((order, 4))
            points(parts, numbers, state, work[WORK:], outputs, what == SHAPE, table)
        if status == ok and what == STEP:
            ends.remember(order, numbers, state, inputs, step)
        return status

    return entry


def _compile(entry: Any) -> tuple[str, Any]:
    """Symbol and LLVM module of an entry, not optimized, without a wrapper for Python."""
    from numba import from_dtype, types
    from numba.core import compiler
    from numba.core.registry import cpu_target

    from cable_model.effects import NUMBERS
    from fmu_src.native import presence

    kinds = {"i": types.int64, "d": types.float64, "p": types.CPointer(types.float64), "n": types.CPointer(from_dtype(NUMBERS))}
    arguments = tuple(kinds[kind] for kind in "iddipnp" + "pi" * len(TABLES) + "pipip")  # as ENTRY
    flags: Any = compiler.Flags()
    flags.no_cpython_wrapper = flags.no_cfunc_wrapper = flags.nrt = True
    flags.enable_pyobject = False
    flags.error_model = "numpy"
    typing_context, target_context = cpu_target.typing_context, cpu_target.target_context
    typing_context.refresh()
    target_context.refresh()
    made = compiler.compile_extra(typing_context, target_context, entry, arguments, types.int64, flags, {})
    return made.fndesc.llvm_func_name, presence.whole(made.library)


def _alone(symbol: str, module: Any, name: str) -> bytes:
    """Bitcode of a module that shows only its entry, as `name`: modules of other processes use the same names for other things."""
    import llvmlite.binding as llvm

    linked = llvm.parse_assembly(RESHAPE)
    linked.link_in(module)
    text = re.sub(rf'@"?{re.escape(symbol)}"?(?![\w.$])', f"@{name}", str(linked))
    for counted in ("NRT_incref", "NRT_decref"):  # no array of the kernels owns its memory
        body = rf"define linkonce_odr void @{counted}\(ptr [^)]*\)[^{{]*{{.*?\n}}"
        text = re.sub(body, f"define void @{counted}(ptr %0) alwaysinline {{ ret void }}", text, flags=re.DOTALL)
    # nobody reads what numba would raise, and it names files of this machine
    text = re.sub(r"(?m)^(@\.const\.picklebuf\S* = internal constant \{[^}]*\}) \{.*\}", r"\1 zeroinitializer", text)
    made = llvm.parse_assembly(text)
    made.verify()
    for value in (*made.functions, *made.global_variables):
        if value.name == name:
            value.visibility = "hidden"
        elif not value.is_declaration:
            value.linkage = "internal"
    bitcode: bytes = made.as_bitcode()
    return bitcode


def _machine(target: Target) -> Any:
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    known = llvm.Target.from_triple(target.triple)
    return known.create_target_machine(cpu=target.processor, features="", opt=3, reloc="pic", codemodel="default")


def _optimized(bitcode: bytes, target: Target) -> bytes:
    """Bitcode of a module, optimized for a platform's processor."""
    import llvmlite.binding as llvm

    module = llvm.parse_bitcode(bitcode)
    tuning = llvm.create_pipeline_tuning_options(speed_level=3)
    tuning.loop_vectorization, tuning.slp_vectorization, tuning.loop_unrolling = True, False, False
    builder = llvm.create_pass_builder(_machine(target), tuning)
    builder.getModulePassManager().run(module, builder)
    made: bytes = module.as_bitcode()
    return made


def _linked(modules: Sequence[bytes], target: Target) -> bytes:
    """Bitcode of one module with the entries of the modules; what they have in common is there once."""
    import llvmlite.binding as llvm

    module = llvm.parse_assembly("")
    for bitcode in modules:
        module.link_in(llvm.parse_bitcode(bitcode))
    builder = llvm.create_pass_builder(_machine(target), llvm.create_pipeline_tuning_options(speed_level=3))
    passes = llvm.create_new_module_pass_manager()
    passes.add_merge_functions_pass()
    passes.run(module, builder)
    own = [value for value in (*module.functions, *module.global_variables) if value.linkage.name == "internal"]
    for k, value in enumerate(own):
        value.name = f"_{k}"  # numba's are long, count what the process compiled, and some are hashes of paths
    wanted = {value.name for value in module.functions if value.is_declaration and not value.name.startswith("llvm.")}
    if wanted - {*EXTERNAL}:
        raise ValueError(f"kernels call {sorted(wanted - {*EXTERNAL})}. Add what libc and libm have to entries.EXTERNAL.")
    made: bytes = module.as_bitcode()
    return made


def object_file(bitcode: bytes, target: Target) -> bytes:
    """Object code for a platform of what `export` made."""
    import llvmlite.binding as llvm

    machine = _machine(target)
    module = llvm.parse_bitcode(bitcode)
    module.triple, module.data_layout = target.triple, str(machine.target_data)
    made: bytes = machine.emit_object(module)
    return made


def export(model: str, variants: Sequence[Variant], target: Target = LINUX) -> bytes:
    """LLVM's bitcode of the entries kernel_0, kernel_1, ... of a model's variants, each compiled in a process of its own.

    Raises ExportError with a process's last words where it fails, finds other kernels than this process, or takes longer than LONGEST.
    """
    from cable_model.kernels.jit import source_hash

    common = {"model": model, "kernels": source_hash(), "processor": target.processor}
    requests = [{**common, "variant": dict(variant), "name": f"kernel_{k}"} for k, variant in enumerate(variants)]
    return _linked(list(_PROCESSES.map(_bitcode, requests)), target)


def _bitcode(request: Mapping[str, Any]) -> bytes:
    """What `main` writes for a request, in a process of its own."""
    try:
        done = subprocess.run(
            [sys.executable, "-m", "fmu_src.native.export"],
            input=json.dumps(request).encode(), capture_output=True, cwd=ROOT, env={**os.environ, **ENVIRONMENT}, check=False,
            timeout=LONGEST,
        )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        raise ExportError(f"the export of the kernels took longer than {LONGEST} s") from error
    if done.returncode != 0:
        raise ExportError(f"the export of the kernels failed:\n{done.stderr.decode()}")
    return done.stdout


def main() -> None:
    from fmu_src.native import presence

    gc.disable()  # numba makes many objects, and little garbage
    presence.take_over()
    from cable_model.kernels import jit
    from cable_model.models import MODELS

    request = json.load(sys.stdin)
    if request["kernels"] != jit.source_hash():
        raise SystemExit("the kernels' sources have changed since the process that asks was started. Start it again.")
    kernels = MODELS[request["model"]].kernels()
    symbol, module = _compile(_entry(kernels, request["variant"]))
    target = LINUX._replace(processor=request["processor"])
    sys.stdout.buffer.write(_optimized(_alone(symbol, module, request["name"]), target))


if __name__ == "__main__":
    main()
