/* SPDX-License-Identifier: MIT */
/** \file
 * The version of these headers. Before 1.0 a minor version may break API and ABI (docs/reference/compatibility.md).
 * CMakeLists.txt reads the three numbers: they stand here alone. */
#ifndef MESHLODE_VERSION_H
#define MESHLODE_VERSION_H

#define MESHLODE_VERSION_MAJOR 0 /**< grows with incompatible changes, from 1.0 on */
#define MESHLODE_VERSION_MINOR 2 /**< grows with new functions; before 1.0 also with incompatible changes */
#define MESHLODE_VERSION_PATCH 0 /**< grows with fixes */

/** One number to compare: major * 10000 + minor * 100 + patch. */
#define MESHLODE_VERSION (MESHLODE_VERSION_MAJOR * 10000 + MESHLODE_VERSION_MINOR * 100 + MESHLODE_VERSION_PATCH)

#endif
