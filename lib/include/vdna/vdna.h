/** @file vdna/vdna.h
 *  @brief Onboard experience selection: umbrella header and the conventions of the whole API.
 *
 *  Memory. The C99 part (activation, range, hist, int8, window, emd, explain, rank, knn,
 *  localise, trust, select, health, parked) never allocates.
 *  An object with a variable size lives in a block that the caller provides: ask
 *  `vdna_X_mem_size()`, hand the block to `vdna_X_init()`, keep it while the object is in use, and
 *  free it yourself; there is nothing to destroy. Objects that hold resources of the operating
 *  system (an experience file, a network, an LCM socket) have `_open()` and `_close()` instead.
 *
 *  Pointers. `const` inputs are borrowed for the length of the call unless their comment says for
 *  how long. Outputs come last, are named `out_...`, and are untouched when a call fails. NULL is
 *  refused with VDNA_ERR_ARG unless a comment gives it a meaning.
 *
 *  Errors. Functions that can fail return a `vdna_status`: 0 is VDNA_OK. Those that deal with
 *  files, networks or configuration also fill a `vdna_error` with one sentence for people.
 *
 *  Threads. Nothing is global. Different objects may be used from different threads; one object may
 *  be used by one thread at a time, unless its comment promises more.
 *
 *  Units. Distances of histograms are in bins, angles do not occur, times are int64_t
 *  microseconds (`utime` for a camera's stamp), lengths in metres, sizes in bytes.
 *
 *  Layout. Config structs start with `struct_size`, which `_config_init()` fills. They grow at the
 *  end: a struct from a caller compiled with an older header, down to version 0.1, is accepted, and
 *  fields that it lacks get their defaults; a larger or a smaller one is refused. Only fixed-width
 *  integers, float, double, size_t and pointers cross the API; functions do in one place, the table
 *  of vdna/backbone.h, by which a network of the user's own is called.
 *
 *  Privacy. Visible fields of a struct are documented and may be read; objects with private state
 *  (select, window, a network, a connection) are pointers with accessors.
 */
#ifndef VDNA_VDNA_H
#define VDNA_VDNA_H

#include <vdna/activation.h>
#include <vdna/bounds.h>
#include <vdna/camera_time.h>
#include <vdna/emd.h>
#include <vdna/explain.h>
#include <vdna/health.h>
#include <vdna/hist.h>
#include <vdna/int8.h>
#include <vdna/knn.h>
#include <vdna/localise.h>
#include <vdna/parked.h>
#include <vdna/range.h>
#include <vdna/rank.h>
#include <vdna/select.h>
#include <vdna/status.h>
#include <vdna/trust.h>
#include <vdna/version.h>
#include <vdna/window.h>

#endif
