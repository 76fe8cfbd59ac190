"""Sixty-four voxels at a time: comparisons as bit masks, counts of bits, case numbers from eight bit masks.

The functions are written as generic LLVM vector code, so they need no particular processor; LLVM turns them
into the widest instructions at hand. Bit i of a word stands for the i-th of 64 voxels (little-endian
processors).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload

_LANES = 64


def _splat(builder: Any, scalar: Any, vector: Any) -> Any:
    single = builder.insert_element(ir.Constant(vector, ir.Undefined), scalar, ir.Constant(ir.IntType(32), 0))
    everywhere = ir.Constant(ir.VectorType(ir.IntType(32), _LANES), [0] * _LANES)
    return builder.shuffle_vector(single, ir.Constant(vector, ir.Undefined), everywhere)


@intrinsic
def reaches_64(_typing: Any, array: Any, index: Any, threshold: Any) -> Any:
    """Word whose bit i is ``array.flat[index + i] >= threshold`` for 64 values; NaN gives 0.

    `array` is C-contiguous, `index` a flat position, `threshold` of the array's own type; bounds are not
    checked.
    """
    signature = types.uint64(array, types.uintp, array.dtype)
    dtype = array.dtype

    def codegen(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        data = context.make_array(sig.args[0])(context, builder, arguments[0]).data
        scalar = context.get_data_type(dtype)
        vector = ir.VectorType(scalar, _LANES)
        pointer = builder.bitcast(builder.gep(data, [arguments[1]]), vector.as_pointer())
        values = builder.load(pointer, align=dtype.bitwidth // 8)
        limit = _splat(builder, arguments[2], vector)
        if isinstance(dtype, types.Float):
            mask = builder.fcmp_ordered(">=", values, limit)
        elif dtype.signed:
            mask = builder.icmp_signed(">=", values, limit)
        else:
            mask = builder.icmp_unsigned(">=", values, limit)
        return builder.bitcast(mask, ir.IntType(64))

    return signature, codegen


@intrinsic
def case_numbers_64(
    _typing: Any, w0: Any, w1: Any, w2: Any, w3: Any, w4: Any, w5: Any, w6: Any, w7: Any, out: Any
) -> Any:
    """Write the 64 case numbers whose bit c is taken from word wc to ``out``, shape (64,), uint8."""
    signature = types.void(*[types.uint64] * 8, out)

    def codegen(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        data = context.make_array(sig.args[8])(context, builder, arguments[8]).data
        byte = ir.IntType(8)
        vector = ir.VectorType(byte, _LANES)
        flags = ir.VectorType(ir.IntType(1), _LANES)
        total = zero = ir.Constant(vector, [0] * _LANES)
        for corner in range(8):
            value = ir.Constant(vector, [ir.Constant(byte, 1 << corner)] * _LANES)
            mask = builder.bitcast(arguments[corner], flags)
            total = builder.or_(total, builder.select(mask, value, zero))
        builder.store(total, builder.bitcast(data, vector.as_pointer()), align=1)
        return context.get_dummy_value()

    return signature, codegen


@intrinsic
def bit_count(_typing: Any, word: Any) -> Any:
    """Number of set bits of a uint64."""

    def codegen(_context: Any, builder: Any, _sig: Any, arguments: Any) -> Any:
        return builder.ctpop(arguments[0])

    return types.uint64(types.uint64), codegen


@intrinsic
def lowest_bit(_typing: Any, word: Any) -> Any:
    """Position of the lowest set bit of a uint64; 64 when none is set."""

    def codegen(_context: Any, builder: Any, _sig: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], ir.Constant(ir.IntType(1), 0))

    return types.uint64(types.uint64), codegen


@intrinsic
def step_counters(
    _typing: Any, counters: Any, numbers: Any, shift: Any, advance: Any, row: Any, lanes: Any
) -> Any:
    """``numbers = counters + shift[row]``, then ``counters += advance[row]``, over all lanes at once.

    `counters` and `numbers` hold one integer a lane, `shift` and `advance` (rows, lanes) int32; `lanes` is a
    literal number. Nothing is checked.
    """
    if not isinstance(lanes, types.IntegerLiteral):
        return None
    n = lanes.literal_value
    signature = types.void(counters, numbers, shift, advance, types.uintp, lanes)

    def codegen(context: Any, builder: Any, sig: Any, arguments: Any) -> Any:
        def pointer(position: int) -> Any:
            return context.make_array(sig.args[position])(context, builder, arguments[position]).data

        wide = ir.VectorType(context.get_data_type(sig.args[0].dtype), n)
        narrow = ir.VectorType(ir.IntType(32), n)
        first = builder.mul(arguments[4], ir.Constant(arguments[4].type, n))

        def table(position: int) -> Any:
            here = builder.bitcast(builder.gep(pointer(position), [first]), narrow.as_pointer())
            values = builder.load(here, align=4)
            return values if wide == narrow else builder.sext(values, wide)

        size = sig.args[0].dtype.bitwidth // 8
        counter_pointer = builder.bitcast(pointer(0), wide.as_pointer())
        count = builder.load(counter_pointer, align=size)
        number_pointer = builder.bitcast(pointer(1), wide.as_pointer())
        builder.store(builder.add(count, table(2)), number_pointer, align=size)
        builder.store(builder.add(count, table(3)), counter_pointer, align=size)
        return context.get_dummy_value()

    return signature, codegen


def subtract(first: Any, second: Any, like: Any) -> Any:
    """``first - second`` without overflow, as a number of the type of `like`; for compiled code."""
    return type(like)(first) - type(like)(second)


@overload(subtract, inline="always")
def _subtract(first: Any, second: Any, like: Any) -> Any:
    if isinstance(first, types.Integer) and first.bitwidth <= 32:
        # One conversion instead of two, and still exact.
        def of_integers(first: Any, second: Any, like: Any) -> Any:
            return type(like)(np.int64(first) - np.int64(second))

        return of_integers

    def of_others(first: Any, second: Any, like: Any) -> Any:
        return type(like)(first) - type(like)(second)

    return of_others
