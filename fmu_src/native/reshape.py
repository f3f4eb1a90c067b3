"""numba's own function for views of contiguous arrays, as LLVM code: the native FMU has no numba."""

RESHAPE = """
define i32 @numba_attempt_nocopy_reshape(
    i64 %n, ptr %sizes, ptr %strides, i64 %new_n, ptr %new_sizes, ptr %new_strides, i64 %item, i32 %fortran
) {
check:
  %by_rows = icmp eq i32 %fortran, 0
  br i1 %by_rows, label %old, label %impossible
old:
  %rest = phi i64 [ %n, %check ], [ %j, %dense ]
  %wanted = phi i64 [ %item, %check ], [ %above, %dense ]
  %unseen = icmp sgt i64 %rest, 0
  br i1 %unseen, label %dense, label %next
dense:
  %j = sub i64 %rest, 1
  %stride_of_j = getelementptr i64, ptr %strides, i64 %j
  %stride = load i64, ptr %stride_of_j
  %size_of_j = getelementptr i64, ptr %sizes, i64 %j
  %size_j = load i64, ptr %size_of_j
  %above = mul i64 %wanted, %size_j
  %as_wanted = icmp eq i64 %stride, %wanted
  br i1 %as_wanted, label %old, label %impossible
next:
  %left = phi i64 [ %new_n, %old ], [ %k, %axis ]
  %span = phi i64 [ %item, %old ], [ %wider, %axis ]
  %more = icmp sgt i64 %left, 0
  br i1 %more, label %axis, label %done
axis:
  %k = sub i64 %left, 1
  %stride_of_k = getelementptr i64, ptr %new_strides, i64 %k
  store i64 %span, ptr %stride_of_k
  %size_of_k = getelementptr i64, ptr %new_sizes, i64 %k
  %size = load i64, ptr %size_of_k
  %wider = mul i64 %span, %size
  br label %next
done:
  ret i32 1
impossible:
  ret i32 0
}
"""
