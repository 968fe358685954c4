/* The only interface to Embree: all functions that Rust calls, in plain C types.
 *
 * bindgen reads this header and no other. No Embree type appears in it, so the bindings are the
 * same for every installed version; shim.c hides the differences between versions 4 and 3.
 *
 * Functions without a result report errors to the device's error listener, never to the caller.
 */
#ifndef PHOTOSPHERE_SHIM_H
#define PHOTOSPHERE_SHIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Handles, counted by Embree: a scene keeps its geometries and its device. */
typedef struct PsDevice PsDevice;
typedef struct PsGeometry PsGeometry;
typedef struct PsScene PsScene;

/* The id that means "no sphere". */
#define PS_NO_SPHERE UINT32_MAX

/* A query. The layout is that of photosphere's `math::Ray`, which explains the fields. */
typedef struct PsRay {
    _Alignas(64) float origin[3];
    float t_min;
    float direction[3];
    float t_max;
    uint32_t exclude[2];
    float origin_low[3];
    float direction_low[3];
} PsRay;

/* A query result. The layout is that of photosphere's `math::Hit`. */
typedef struct PsHit {
    float t;
    uint32_t id;
} PsHit;

/* All the spheres of a scene as the user wrote them, by id: x, y, z, radius of each. The ids of
 * giants follow those of the particles. */
typedef struct PsSpheres {
    /* The particles in f32; a negative radius marks one that is in `f64_rows`, at the index given
     * by the bits of x. NULL if all are in `f64_rows`. */
    const float *f32_rows;
    const double *f64_rows;
    const double *giants;
    /* The point that rays are relative to. */
    double origin[3];
    uint32_t particle_count;
} PsSpheres;

/* Spheres of similar size, which have an Embree scene of their own. Must not move or change as long
 * as a geometry or a scene made from it lives. */
typedef struct PsGroup {
    PsSpheres spheres;
    /* The ids of the spheres; NULL if they are the first ones. */
    const uint32_t *ids;
    uint32_t count;
    /* The spheres as sphere points: x, y, z relative to the origin, and the enlarged radius. */
    const float *points;
    /* How many f32 numbers above the radius as written the enlarged radius is, the points being
     * exact otherwise; 0 if the points do not tell. */
    uint32_t radius_steps;
    /* A ball that contains all spheres of the group. */
    double center[3], radius;
    /* How far f32 may displace a surface, and how far a candidate's distance may be off. */
    double enlargement, slack;
    /* The square of half a chord, per enlarged radius, above which a sphere point is certainly hit.
     */
    float certain_chord;
} PsGroup;

/* ---- Devices ---- */

/* Versions and features of a device. */
typedef struct PsDescription {
    /* The version of the headers that the shim was compiled against, and that of the library that
     * runs: 10000 major + 100 minor + patch. */
    uint32_t compiled_version;
    uint32_t runtime_version;
    /* The widest ray packet that the selected instructions process at once: 1, 4, 8 or 16. */
    uint32_t packet_width;
    /* 0: Embree's own, 1: TBB, 2: PPL. */
    uint32_t tasking;
    bool sphere_points;
    bool user_geometry;
    bool filters;
    /* 1 if spheres are invisible from inside, 0 if not; -1: this version does not report it. */
    int32_t culls_sphere_back_faces;
} PsDescription;

/* The error code that the caller treats specially. */
enum { PS_ERROR_CANCELLED = 6 };

/* Called with a code and a text, from any thread that works for the device. */
typedef void (*PsErrorListener)(void *listener, uint32_t code, const char *text);
/* Called with the number of bytes about to be allocated, or just freed (negative), from any thread
 * that works for the device. */
typedef bool (*PsMemoryListener)(void *listener, ptrdiff_t bytes, bool after);

/* NULL on failure; ps_creation_error() then says why, once. */
PsDevice *ps_device_new(const char *config);
uint32_t ps_creation_error(void);
void ps_device_release(PsDevice *device);
void ps_device_on_error(PsDevice *device, PsErrorListener report, void *listener);
void ps_device_on_memory(PsDevice *device, PsMemoryListener count, void *listener);
void ps_device_describe(PsDevice *device, PsDescription *description);

/* ---- Geometries ---- */

/* The spheres of a group, as sphere points that share the array. */
PsGeometry *ps_points_new(PsDevice *device, const PsGroup *group);
/* The spheres of a group, as user geometry. */
PsGeometry *ps_user_new(PsDevice *device, const PsGroup *group);
void ps_geometry_commit(PsGeometry *geometry);
void ps_geometry_release(PsGeometry *geometry);

/* ---- Scenes ---- */

/* Called during a commit, from any thread that works for the device; false stops the commit. */
typedef bool (*PsProgressListener)(void *listener, double done);

PsScene *ps_scene_new(PsDevice *device);
void ps_scene_attach(PsScene *scene, PsGeometry *geometry);
void ps_scene_on_progress(PsScene *scene, PsProgressListener go_on, void *listener);
void ps_scene_commit(PsScene *scene);
void ps_scene_release(PsScene *scene);

/* ---- Queries of committed scenes, from any number of threads ---- */

/* A committed scene and the group that it was made from. */
typedef struct PsTarget {
    PsScene *scene;
    const PsGroup *group;
} PsTarget;

/* The first sphere that each ray hits; invalid rays hit nothing. */
void ps_closest(const PsTarget *targets, size_t target_count, const PsRay *rays, size_t count,
                PsHit *hits);
/* True for each ray that hits anything; invalid rays do not. */
void ps_occluded(const PsTarget *targets, size_t target_count, const PsRay *rays, size_t count,
                 bool *occluded);

#endif
