# SPDX-License-Identifier: GPL-3.0-or-later
"""The rules of the tables: ids, ranges, enumerators, and who partitions what (docs/reference/format.md, sections 4 to 11)."""

import math
import struct

from rules import INFINITE, NONE, check

MAX_PAGE = 131072
TERMINAL, STUCK, AGGREGATE = 1, 2, 4


def check_strings(tables):
    size = len(tables["STRS"])
    for name, fields in (("MESH", ("name",)), ("MATL", ("name",)), ("INST", ("name",)), ("BLBT", ("name", "mime_type"))):
        for i, record in enumerate(tables[name]):
            for field in fields:
                offset, count = record[field]
                check(offset + count <= size, f"section {name}, record {i}, field {field}", "leaves the strings")


def check_partition(owners, first, count, total, place):
    """Each owner's range starts where the one before it ended, and the last ends the table."""
    end = 0
    for i, owner in enumerate(owners):
        check(owner[first] == end, f"{place}, record {i}, field {first}", "leaves a gap")
        end += owner[count]
    check(end == total, f"{place}, record {len(owners)}, field {first}", "something is left over")


def check_meshes(tables):
    meshes = tables["MESH"]
    for i, mesh in enumerate(meshes):
        place = f"section MESH, record {i}, field "
        check(-126 <= mesh["grid_log2"] <= 104, place + "grid.log2")
        check(1 <= mesh["grid_mantissa"] < 1 << 24, place + "grid.mantissa")
        check(all(low <= high for low, high in zip(mesh["bounds_min"], mesh["bounds_max"])), place + "bounds_max")
        check(all(abs(b) < 1 << 23 for b in mesh["bounds_min"] + mesh["bounds_max"]), place + "bounds_min")
        check(-126 <= mesh["sphere_log2"] <= 104, place + "sphere_log2")
        check(mesh["diagonal"] <= 1 << 63, place + "diagonal", "is negative")  # -0.0 is not
        check(mesh["level0_deviation"] <= 1 << 31, place + "level0_deviation", "is negative")
        check(mesh["error_tier"] <= 2, place + "error_tier")
        check(mesh["normal_mode"] <= 2, place + "normal_mode")
        scale = mesh["normal_scale"]
        check(1 <= scale <= 8191 if mesh["normal_mode"] == 1 else scale == 0, place + "normal_scale")
        check(mesh["uv_set_count"] <= 4, place + "uv_set_count")
        check(mesh["has_color"] <= 1, place + "has_color")
        for k, log2 in enumerate(mesh["uv_log2"]):
            check(-126 <= log2 <= 104 if k < mesh["uv_set_count"] else log2 == 0, place + "uv_log2")
        check(mesh["material"] == NONE or mesh["material"] < len(tables["MATL"]), place + "material")
        check(mesh["level_count"] <= 65536, place + "level_count")
        empty = [mesh[f] == 0 for f in ("group_count", "cluster_count", "node_count", "level_count")]
        check(all(empty) or not any(empty), place + "level_count", "a mesh is empty or it is not")
    for name, what in (("GRUP", "group"), ("CLUS", "cluster"), ("NODE", "node")):
        check_partition(meshes, f"first_{what}", f"{what}_count", len(tables[name]), "section MESH")


def check_dag(tables):
    groups, clusters = tables["GRUP"], tables["CLUS"]
    for m, mesh in enumerate(tables["MESH"]):
        level = 65536
        for g in range(mesh["first_group"], mesh["first_group"] + mesh["group_count"]):
            group, place = groups[g], f"section GRUP, record {g}, field "
            check(group["mesh"] == m, place + "mesh")
            check(group["level"] <= level and group["level"] < mesh["level_count"], place + "level")
            level = group["level"]
            check(group["cluster_count"] >= 1, place + "cluster_count")
            allowed = (0, TERMINAL, TERMINAL | STUCK) + ((AGGREGATE,) if tables["version"] == 2 else ())
            check(group["flags"] in allowed, place + "flags")
            for field in ("radius", "error", "quadric_error", "deviation", "normal_deviation", "uv_deviation"):
                check(group[field] <= 0x80000000, place + field, "is negative")  # -0.0 is not
            check((group["error"] == INFINITE) == bool(group["flags"] & TERMINAL), place + "error")
            check((group["stuck_reason"] != 0) == bool(group["flags"] & STUCK) and group["stuck_reason"] <= 7,
                  place + "stuck_reason")
    check_partition(groups, "first_cluster", "cluster_count", len(clusters), "section GRUP")
    for g, group in enumerate(groups):
        levels = []
        for c in range(group["first_cluster"], group["first_cluster"] + group["cluster_count"]):
            cluster, place = clusters[c], f"section CLUS, record {c}, field "
            check(cluster["coarser_group"] == g, place + "coarser_group")
            own = cluster["own_group"]
            check((own == NONE) == (cluster["level"] == 0), place + "own_group")
            if own != NONE:
                check(g < own < len(groups) and groups[own]["mesh"] == group["mesh"], place + "own_group")
                check(not groups[own]["flags"] & TERMINAL and groups[own]["level"] < cluster["level"], place + "own_group")
            check(cluster["vertices_less_1"] < 3 * (cluster["triangles_less_1"] + 1), place + "vertices_less_1")
            levels.append(cluster["level"])
        check(max(levels) == group["level"], f"section GRUP, record {g}, field level")


def check_promises(tables):
    """Floats are their bits: of those that are not negative the order is that of the numbers."""
    if not tables["has_promises"]:
        return
    meshes, groups = tables["PRMS"], tables["PRMG"]
    check(len(meshes) == len(tables["MESH"]), "section PRMS, field record_count")
    check(len(groups) == len(tables["GRUP"]), "section PRMG, field record_count")
    for i, (promise, mesh) in enumerate(zip(meshes, tables["MESH"])):
        place = f"section PRMS, record {i}, field "
        check(promise["promises"] in (1, 3) and promise["promises"] == meshes[0]["promises"], place + "promises")
        appears = promise["promises"] & 2
        check(promise["normal_object"] <= (INFINITE if appears else 0), place + "normal_object")
        for k in range(4):
            u, v = promise["uv_object"][2 * k:2 * k + 2]
            check(max(u, v) <= INFINITE and (u == 0) == (v == 0) and (k < mesh["uv_set_count"] or u == 0),
                  place + "uv_object")
        check(mesh["level0_deviation"] & ~(1 << 31) <= promise["level0_texels"] <= INFINITE, place + "level0_texels")
        least = promise["level0_texels"] if appears else 0
        check(least <= promise["level0_appearance"] <= (INFINITE if appears else 0), place + "level0_appearance")
    for i, (promise, group) in enumerate(zip(groups, tables["GRUP"])):
        place = f"section PRMG, record {i}, field "
        terminal = bool(group["flags"] & TERMINAL)
        texels, appearance = promise["texel_error"], promise["appearance_error"]
        check(group["error"] & ~(1 << 31) <= texels <= INFINITE and (texels == INFINITE) == terminal,
              place + "texel_error")
        if meshes[group["mesh"]]["promises"] & 2:
            check(texels <= appearance <= INFINITE and (appearance == INFINITE) == terminal, place + "appearance_error")
        else:
            check(appearance == 0, place + "appearance_error")


def check_nodes(tables):
    nodes = tables["NODE"]
    for mesh in tables["MESH"]:
        first, end = mesh["first_node"], mesh["first_node"] + mesh["node_count"]
        parents = [0] * mesh["node_count"]
        depth = [1] * mesh["node_count"]
        for n in range(first, end):
            node, place = nodes[n], f"section NODE, record {n}, field "
            check(node["radius"] <= 1 << 31 and node["error"] <= 1 << 31, place + "radius", "is negative")
            check(node["child_count"] <= 8, place + "child_count")
            if node["child_count"] == 0:
                group = node["first"] - mesh["first_group"]
                check(0 <= group < mesh["group_count"], place + "first")
                continue
            check(n < node["first"] and node["first"] + node["child_count"] <= end, place + "first")
            for child in range(node["first"], node["first"] + node["child_count"]):
                parents[child - first] += 1
                depth[child - first] = depth[n - first] + 1
        check(max(depth, default=0) <= 64, "section NODE", "is deeper than 64 nodes")
        check(parents[1:] == [1] * (len(parents) - 1), "section NODE", "is not one tree a mesh")


def check_instances(tables):
    for i, instance in enumerate(tables["INST"]):
        place = f"section INST, record {i}, field "
        check(instance["mesh"] < len(tables["MESH"]), place + "mesh")
        is_zero = instance["scale"] & ~(1 << 63) == 0
        check(instance["flags"] & 2 if is_zero else instance["scale"] >> 63 == 0, place + "scale")
        check(instance["flags"] in (0, 1, 2), place + "flags")


def check_pages(tables):
    pages, groups = tables["PAGT"], tables["GRUP"]
    check_partition(pages, "first_group", "group_count", len(groups), "section PAGT")
    check_partition(pages, "first_cluster", "cluster_count", len(tables["CLUS"]), "section PAGT")
    check_partition(pages, "first_dependency", "dependency_count", len(tables["PDEP"]), "section PAGT")
    end, data = tables["PAGE"]["offset"], tables["PAGE"]
    for p, page in enumerate(pages):
        place = f"section PAGT, record {p}, field "
        check(page["group_count"] >= 1, place + "group_count")
        members = groups[page["first_group"]:page["first_group"] + page["group_count"]]
        check(all(g["page"] == p and g["mesh"] == members[0]["mesh"] for g in members), place + "group_count")
        check(page["first_cluster"] == members[0]["first_cluster"], place + "first_cluster")
        check(sum(g["cluster_count"] for g in members) == page["cluster_count"], place + "cluster_count")
        check(page["bytes"] % 4 == 0 and page["bytes"] <= MAX_PAGE, place + "bytes")
        check(page["codec"] <= 4, place + "codec")
        check(page["stored_bytes"] == page["bytes"] if page["codec"] == 0 else page["stored_bytes"] < page["bytes"],
              place + "stored_bytes")
        check(page["offset"] == (end + 15) // 16 * 16, place + "offset")
        end = page["offset"] + page["stored_bytes"]
        needed = tables["PDEP"][page["first_dependency"]:page["first_dependency"] + page["dependency_count"]]
        check(all(a < b for a, b in zip(needed, needed[1:] + [p])), place + "first_dependency")
        check(needed == dependencies_of(p, page, tables), place + "first_dependency", "are not its dependencies")
    check(end == data["offset"] + data["bytes"], f"section PAGT, record {len(pages)}, field offset")


def dependencies_of(index, page, tables):
    if "made_from" not in tables:  # group -> pages of the clusters made from it
        tables["made_from"] = {}
        for cluster in tables["CLUS"]:
            where = tables["GRUP"][cluster["coarser_group"]]["page"]
            tables["made_from"].setdefault(cluster["own_group"], set()).add(where)
    needed = set()
    for g in range(page["first_group"], page["first_group"] + page["group_count"]):
        needed |= tables["made_from"].get(g, set())
    return sorted(needed - {index})


def check_hints(tables):
    """Their form; what they say of the groups is for `hold_hints`. Floats are their bits, and finite."""
    if not tables["has_hints"]:
        return
    check(len(tables["PHNT"]) == len(tables["PAGT"]), "section PHNT, field record_count")
    for i, hint in enumerate(tables["PHNT"]):
        place = f"section PHNT, record {i}, field "
        check(hint["radius"] <= INFINITE, place + "radius", "is negative")
        least, most = hint["smallest_error"], hint["largest_error"]
        check(least <= INFINITE, place + "smallest_error", "is negative")
        check(least <= most <= INFINITE, place + "largest_error")


def hold_hints(tables):
    """Rule L217: a hint contains the spheres of its page's groups, and has their largest and smallest error."""
    def number(bits):
        return struct.unpack("<f", struct.pack("<I", bits))[0]

    for i, (hint, page) in enumerate(zip(tables["PHNT"], tables["PAGT"])):
        place = f"section PHNT, record {i}, field "
        groups = tables["GRUP"][page["first_group"]:page["first_group"] + page["group_count"]]
        errors = [group["error"] for group in groups]
        check(hint["largest_error"] == max(errors), place + "largest_error")
        check(hint["smallest_error"] == min(errors), place + "smallest_error")
        for group in groups:
            away = math.dist([number(x) for x in group["center"]], [number(x) for x in hint["center"]])
            is_held = hint["radius"] == INFINITE or away + number(group["radius"]) <= number(hint["radius"])
            check(is_held, place + "radius", "does not reach its groups")


def check_blobs(tables):
    end = tables["BLOB"]["offset"]
    for i, blob in enumerate(tables["BLBT"]):
        place = f"section BLBT, record {i}, field "
        check(blob["kind"] in (1, 2), place + "kind")
        check(blob["offset"] == (end + 15) // 16 * 16, place + "offset")
        end = blob["offset"] + blob["bytes"]
    check(end == tables["BLOB"]["offset"] + tables["BLOB"]["bytes"], f"section BLBT, record {len(tables['BLBT'])}")


def check_tables(tables):
    check_strings(tables)
    check_meshes(tables)
    for i, material in enumerate(tables["MATL"]):
        check(material["alpha_mode"] <= 2, f"section MATL, record {i}, field alpha_mode")
        check(material["double_sided"] <= 1, f"section MATL, record {i}, field double_sided")
    check_instances(tables)
    check_dag(tables)
    check_promises(tables)
    check_nodes(tables)
    check_pages(tables)
    check_hints(tables)
    check_blobs(tables)
