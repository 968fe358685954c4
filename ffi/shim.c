/* Implements shim.h with Embree 4 or 3, whichever build.rs found (EMBREE_MAJOR).
 *
 * The first section hides the differences between the two versions. Embree only finds candidates.
 * Wherever its f32 arithmetic leaves a question open, candidates are tested by the same two
 * functions, first_root() and counts(), in f64 and with the numbers that the user wrote. So hits,
 * exclusion, the open interval and ties follow the same rules for sphere points and user geometry,
 * and the result depends neither on the order in which Embree visits the spheres nor on its
 * arithmetic.
 *
 * No candidate is lost, because all spheres are enlarged for Embree by a bound on its errors in f32
 * (PsGroup, derived in src/accel/embree/group.rs), and because Embree's ray starts where it enters
 * the ball around the group, so that these errors do not grow with the ray's length.
 */
#include "shim.h"

#if EMBREE_MAJOR == 4
#include <embree4/rtcore.h>
#elif EMBREE_MAJOR == 3
#include <embree3/rtcore.h>
#else
#error "EMBREE_MAJOR must be 4 or 3"
#endif

#include <float.h>
#include <math.h>
#include <string.h>

_Static_assert(sizeof(PsRay) == 64, "a ray is one cache line");
_Static_assert(FLT_EVAL_METHOD == 0, "the same arithmetic as on the Rust side");
_Static_assert((int)PS_ERROR_CANCELLED == (int)RTC_ERROR_CANCELLED, "Embree's own code");

/* ---- Embree 4 or 3 ---- */

#if EMBREE_MAJOR == 4
typedef struct RTCRayQueryContext Context;
#else
typedef struct RTCIntersectContext Context;
#endif

/* The state of a query, for the callbacks. Embree passes its context to every callback; it is the
 * first member, so that a pointer to it is also a pointer to the query. */
typedef struct Query {
    Context context;
    const PsRay *ray;
    /* The ray to 48 bits; the length of its direction, for Embree's ray, and one over it. */
    double origin[3], direction[3], length, per_length;
    /* Where Embree's ray starts, and the slack of the group being traced. */
    double start, slack;
    /* The first hit so far. */
    double t;
    uint32_t id;
    /* The index of a sphere point that is certainly hit, and before any other so far, but whose
     * distance has not been computed in f64 yet; PS_NO_SPHERE if there is none. */
    uint32_t pending;
    /* Along Embree's ray: candidates beyond `certain_from` are certainly beyond t_min, and those
     * before `certain_until` are certainly before t_max and before the first hit so far. */
    float certain_from, certain_until;
} Query;

#if EMBREE_MAJOR == 4

static void init_context(Query *query) { rtcInitRayQueryContext(&query->context); }

static void trace_closest(RTCScene scene, Query *query, struct RTCRayHit *rayhit) {
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &query->context;
    rtcIntersect1(scene, rayhit, &arguments);
}

static void trace_occluded(RTCScene scene, Query *query, struct RTCRay *ray) {
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &query->context;
    rtcOccluded1(scene, ray, &arguments);
}

#else

static void init_context(Query *query) { rtcInitIntersectContext(&query->context); }

static void trace_closest(RTCScene scene, Query *query, struct RTCRayHit *rayhit) {
    rtcIntersect1(scene, &query->context, rayhit);
}

static void trace_occluded(RTCScene scene, Query *query, struct RTCRay *ray) {
    rtcOccluded1(scene, &query->context, ray);
}

#endif

/* ---- One sphere and one ray, in f64 ---- */

typedef struct Sphere {
    double center[3], radius;
} Sphere;

static Sphere relative_to_origin(const PsSpheres *spheres, double x, double y, double z, double r) {
    const double *origin = spheres->origin;
    return (Sphere){{x - origin[0], y - origin[1], z - origin[2]}, r};
}

/* `SphereSet::sphere` of photosphere's geometry. */
static Sphere sphere_at(const PsSpheres *spheres, uint32_t id) {
    const double *s;
    if (id >= spheres->particle_count) {
        s = &spheres->giants[4 * (size_t)(id - spheres->particle_count)];
    } else if (spheres->f32_rows) {
        const float *row = &spheres->f32_rows[4 * (size_t)id];
        if (row[3] >= 0.0f) return relative_to_origin(spheres, row[0], row[1], row[2], row[3]);
        uint32_t index;
        memcpy(&index, &row[0], sizeof index);
        s = &spheres->f64_rows[4 * (size_t)index];
    } else {
        s = &spheres->f64_rows[4 * (size_t)id];
    }
    return relative_to_origin(spheres, s[0], s[1], s[2], s[3]);
}

/* Of a particle, so that its row is there when it is needed. */
static void prefetch(const PsSpheres *spheres, uint32_t id) {
    if (spheres->f32_rows)
        __builtin_prefetch(&spheres->f32_rows[4 * (size_t)id]);
    else
        __builtin_prefetch(&spheres->f64_rows[4 * (size_t)id]);
}

static uint32_t id_of(const PsGroup *group, uint32_t index) {
    return group->ids ? group->ids[index] : index;
}

/* The sphere with this index in the group. */
static Sphere sphere_in(const PsGroup *group, uint32_t index) {
    if (!group->radius_steps) return sphere_at(&group->spheres, id_of(group, index));
    const float *point = &group->points[4 * (size_t)index];
    uint32_t bits;
    float radius;
    memcpy(&bits, &point[3], sizeof bits);
    bits -= group->radius_steps;
    memcpy(&radius, &bits, sizeof radius);
    return (Sphere){{point[0], point[1], point[2]}, radius};
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* `Sphere::first_root` of photosphere's geometry, operation by operation, so that it gives the same
 * bits. The far root if the near one is not beyond t_min; NAN if the line misses the sphere. */
static double first_root(const PsGroup *group, uint32_t index, const Query *query) {
    const Sphere found = sphere_in(group, index), *sphere = &found;
    const double *o = query->origin, *d = query->direction, *c = sphere->center;
    const double to_center[3] = {c[0] - o[0], c[1] - o[1], c[2] - o[2]};
    double per_length_squared = 1.0 / dot(d, d);
    double t = dot(to_center, d) * per_length_squared;
    const double perpendicular[3] = {to_center[0] - d[0] * t, to_center[1] - d[1] * t,
                                     to_center[2] - d[2] * t};
    double discriminant = sphere->radius * sphere->radius - dot(perpendicular, perpendicular);
    double half_chord_squared = discriminant * per_length_squared;
    if (!(half_chord_squared >= 0.0)) return NAN;
    double h = sqrt(half_chord_squared);
    return t - h > query->ray->t_min ? t - h : t + h;
}

/* ---- Which hits are accepted ---- */

static bool is_excluded(const PsRay *ray, uint32_t id) {
    return id == ray->exclude[0] || id == ray->exclude[1];
}

static bool counts(const PsRay *ray, uint32_t id, double t) {
    return !is_excluded(ray, id) && t > ray->t_min && t < ray->t_max;
}

/* Returns true if this hit is the first so far, and then stores it. At equal distances, the hit
 * with the lowest id is first, as in brute force. */
static bool accept(Query *query, uint32_t id, double t) {
    if (!counts(query->ray, id, t)) return false;
    if (!(t < query->t || (t == query->t && id < query->id))) return false;
    query->t = t;
    query->id = id;
    return true;
}

/* Not less than x >= 0. */
static float round_up(double x) { return (float)x * (1.0f + 2.0f * FLT_EPSILON); }

/* fmin without NAN handling, which would cost a call. */
static double least(double a, double b) { return a < b ? a : b; }

/* The distance up to which Embree must search for spheres whose exact distance is below t. */
static float search_until(const Query *query, double t) {
    return round_up((t - query->start) * query->length + query->slack);
}

/* ---- Sphere points ---- */

/* True if the candidate is a hit beyond doubt: the ray enters the sphere as written, within the
 * ray's interval. Embree's normal, times the unit direction, is half the chord in the enlarged
 * sphere; group.rs derives how long it must be. */
static bool is_certain(const Query *query, const PsGroup *group, const struct RTCRay *ray,
                       const struct RTCHit *hit) {
    float enlarged = group->points[4 * (size_t)hit->primID + 3];
    float cosine = hit->Ng_x * ray->dir_x + hit->Ng_y * ray->dir_y + hit->Ng_z * ray->dir_z;
    return cosine < 0.0f && cosine * cosine > group->certain_chord * enlarged &&
           ray->tfar > query->certain_from && ray->tfar < query->certain_until;
}

/* Computes the distance of the pending sphere. */
static void settle(Query *query, const PsGroup *group) {
    uint32_t index = query->pending;
    if (index == PS_NO_SPHERE) return;
    query->pending = PS_NO_SPHERE;
    accept(query, id_of(group, index), first_root(group, index, query));
}

/* Filters. Embree has put the candidate's distance into `tfar`. Setting `valid` to 0 rejects the
 * candidate; Embree then restores the ray and calls the filter for the far root of the sphere. The
 * callbacks are only called for single rays, where RTCRayN and RTCHitN are RTCRay and RTCHit.
 * Embree allows a filter to change `tfar` and continues with the new value, which is never larger
 * than before the candidate. */

static void filter_closest(const struct RTCFilterFunctionNArguments *arguments) {
    const PsGroup *group = arguments->geometryUserPtr;
    struct RTCRay *ray = (struct RTCRay *)arguments->ray;
    const struct RTCHit *hit = (const struct RTCHit *)arguments->hit;
    Query *query = (Query *)arguments->context;
    uint32_t id = id_of(group, hit->primID);
    if (is_excluded(query->ray, id)) {
        arguments->valid[0] = 0;
    } else if (is_certain(query, group, ray, hit)) {
        query->pending = hit->primID;
        if (!group->radius_steps) prefetch(&group->spheres, id);
        query->certain_until = ray->tfar - 2.0f * (float)query->slack;
        ray->tfar += 2.0f * (float)query->slack;
    } else {
        settle(query, group);
        if (accept(query, id, first_root(group, hit->primID, query))) {
            ray->tfar = search_until(query, query->t);
            query->certain_until = ray->tfar - 2.0f * (float)query->slack;
        } else {
            arguments->valid[0] = 0;
        }
    }
}

static void filter_occluded(const struct RTCFilterFunctionNArguments *arguments) {
    const PsGroup *group = arguments->geometryUserPtr;
    const struct RTCRay *ray = (const struct RTCRay *)arguments->ray;
    const struct RTCHit *hit = (const struct RTCHit *)arguments->hit;
    const Query *query = (const Query *)arguments->context;
    uint32_t id = id_of(group, hit->primID);
    if (is_excluded(query->ray, id)) {
        arguments->valid[0] = 0;
    } else if (!is_certain(query, group, ray, hit)) {
        if (!counts(query->ray, id, first_root(group, hit->primID, query))) arguments->valid[0] = 0;
    }
}

/* ---- User geometry ---- */

/* The enlargement covers the rounding to f32. */
static void user_bounds(const struct RTCBoundsFunctionArguments *arguments) {
    const PsGroup *group = arguments->geometryUserPtr;
    Sphere sphere = sphere_at(&group->spheres, id_of(group, arguments->primID));
    double reach = sphere.radius + group->enlargement;
    float lower[3], upper[3];
    for (int axis = 0; axis < 3; axis++) {
        lower[axis] = (float)(sphere.center[axis] - reach);
        upper[axis] = (float)(sphere.center[axis] + reach);
    }
    struct RTCBounds *bounds = arguments->bounds_o;
    bounds->lower_x = lower[0], bounds->lower_y = lower[1], bounds->lower_z = lower[2];
    bounds->upper_x = upper[0], bounds->upper_y = upper[1], bounds->upper_z = upper[2];
}

static void user_closest(const struct RTCIntersectFunctionNArguments *arguments) {
    if (!arguments->valid[0]) return;
    const PsGroup *group = arguments->geometryUserPtr;
    struct RTCRayHit *rayhit = (struct RTCRayHit *)arguments->rayhit;
    Query *query = (Query *)arguments->context;
    uint32_t id = id_of(group, arguments->primID);
    if (!accept(query, id, first_root(group, arguments->primID, query))) return;
    rayhit->ray.tfar = search_until(query, query->t);
    rayhit->hit.primID = arguments->primID;
    rayhit->hit.geomID = arguments->geomID;
}

static void user_occluded(const struct RTCOccludedFunctionNArguments *arguments) {
    if (!arguments->valid[0]) return;
    const PsGroup *group = arguments->geometryUserPtr;
    struct RTCRay *ray = (struct RTCRay *)arguments->ray;
    const Query *query = (const Query *)arguments->context;
    uint32_t id = id_of(group, arguments->primID);
    if (counts(query->ray, id, first_root(group, arguments->primID, query))) ray->tfar = -INFINITY;
}

/* ---- Devices ---- */

PsDevice *ps_device_new(const char *config) { return (PsDevice *)rtcNewDevice(config); }

uint32_t ps_creation_error(void) { return rtcGetDeviceError(NULL); }

void ps_device_release(PsDevice *device) { rtcReleaseDevice((RTCDevice)device); }

void ps_device_on_error(PsDevice *device, PsErrorListener report, void *listener) {
    rtcSetDeviceErrorFunction((RTCDevice)device, report, listener);
}

void ps_device_on_memory(PsDevice *device, PsMemoryListener count, void *listener) {
    rtcSetDeviceMemoryMonitorFunction((RTCDevice)device, count, listener);
}

static uint32_t property(PsDevice *device, enum RTCDeviceProperty name) {
    return (uint32_t)rtcGetDeviceProperty((RTCDevice)device, name);
}

void ps_device_describe(PsDevice *device, PsDescription *description) {
    uint32_t width = 1;
    if (property(device, RTC_DEVICE_PROPERTY_NATIVE_RAY4_SUPPORTED)) width = 4;
    if (property(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) width = 8;
    if (property(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) width = 16;
    *description = (PsDescription){
        .compiled_version = RTC_VERSION,
        .runtime_version = property(device, RTC_DEVICE_PROPERTY_VERSION),
        .packet_width = width,
        .tasking = property(device, RTC_DEVICE_PROPERTY_TASKING_SYSTEM),
        .sphere_points = property(device, RTC_DEVICE_PROPERTY_POINT_GEOMETRY_SUPPORTED),
        .user_geometry = property(device, RTC_DEVICE_PROPERTY_USER_GEOMETRY_SUPPORTED),
        .filters = property(device, RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED),
        .culls_sphere_back_faces = -1,
    };
#if RTC_VERSION_MAJOR == 3
    /* Embree 3 has no such culling. */
    description->culls_sphere_back_faces = 0;
#elif RTC_VERSION >= 40303
    description->culls_sphere_back_faces =
        (int32_t)property(device, RTC_DEVICE_PROPERTY_BACKFACE_CULLING_SPHERES_ENABLED);
#endif
}

/* ---- Geometries ---- */

PsGeometry *ps_points_new(PsDevice *device, const PsGroup *group) {
    RTCGeometry geometry = rtcNewGeometry((RTCDevice)device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                               group->points, 0, 4 * sizeof(float), group->count);
    rtcSetGeometryUserData(geometry, (void *)group);
    rtcSetGeometryIntersectFilterFunction(geometry, filter_closest);
    rtcSetGeometryOccludedFilterFunction(geometry, filter_occluded);
    return (PsGeometry *)geometry;
}

PsGeometry *ps_user_new(PsDevice *device, const PsGroup *group) {
    RTCGeometry geometry = rtcNewGeometry((RTCDevice)device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, group->count);
    rtcSetGeometryUserData(geometry, (void *)group);
    rtcSetGeometryBoundsFunction(geometry, user_bounds, NULL);
    rtcSetGeometryIntersectFunction(geometry, user_closest);
    rtcSetGeometryOccludedFunction(geometry, user_occluded);
    return (PsGeometry *)geometry;
}

void ps_geometry_commit(PsGeometry *geometry) { rtcCommitGeometry((RTCGeometry)geometry); }

void ps_geometry_release(PsGeometry *geometry) { rtcReleaseGeometry((RTCGeometry)geometry); }

/* ---- Scenes ---- */

PsScene *ps_scene_new(PsDevice *device) {
    RTCScene scene = rtcNewScene((RTCDevice)device);
    /* Conservative box tests; for spheres they cost nothing measurable. */
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    return (PsScene *)scene;
}

void ps_scene_attach(PsScene *scene, PsGeometry *geometry) {
    rtcAttachGeometry((RTCScene)scene, (RTCGeometry)geometry);
}

void ps_scene_on_progress(PsScene *scene, PsProgressListener go_on, void *listener) {
    rtcSetSceneProgressMonitorFunction((RTCScene)scene, go_on, listener);
}

void ps_scene_commit(PsScene *scene) { rtcCommitScene((RTCScene)scene); }

void ps_scene_release(PsScene *scene) { rtcReleaseScene((RTCScene)scene); }

/* ---- Queries ---- */

/* True if the ray may be traced: `math::Ray::is_valid`, with its limit, 4 MAX_COORDINATE. */
static bool is_valid(const PsRay *ray) {
    const float limit = 4.0f * 1e15f;
    bool bounded = true;
    for (int axis = 0; axis < 3; axis++)
        bounded &= fabsf(ray->origin[axis]) <= limit && fabsf(ray->direction[axis]) <= limit;
    return bounded && ray->t_min >= 0.0f && ray->t_min <= limit && ray->t_max >= 0.0f;
}

/* Directions of unit length need neither a root nor a division. */
static void begin(Query *query, const PsRay *ray) {
    query->ray = ray;
    for (int axis = 0; axis < 3; axis++) {
        query->origin[axis] = (double)ray->origin[axis] + ray->origin_low[axis];
        query->direction[axis] = (double)ray->direction[axis] + ray->direction_low[axis];
    }
    double squared = dot(query->direction, query->direction);
    query->length = query->per_length = 1.0;
    if (!(fabs(squared - 1.0) < FLT_EPSILON)) {
        query->length = sqrt(squared);
        query->per_length = 1.0 / query->length;
    }
    query->t = INFINITY;
    query->id = PS_NO_SPHERE;
    query->pending = PS_NO_SPHERE;
    init_context(query);
}

/* Cuts a ray's interval to where the ray is in the ball around a group. Returns false if that
 * leaves less than nothing. */
static bool clip(const Query *query, const PsGroup *group, double *enter, double *leave) {
    const double *o = query->origin, *d = query->direction, *c = group->center;
    double t_min = *enter, radius_squared = group->radius * group->radius;
    const double from_start[3] = {c[0] - (o[0] + d[0] * t_min), c[1] - (o[1] + d[1] * t_min),
                                  c[2] - (o[2] + d[2] * t_min)};
    /* Most rays start in the ball; nothing is hit behind it. */
    if (dot(from_start, from_start) <= radius_squared) return true;
    const double to_center[3] = {c[0] - o[0], c[1] - o[1], c[2] - o[2]};
    double per_length_squared = query->per_length * query->per_length;
    double middle = dot(to_center, d) * per_length_squared;
    const double perpendicular[3] = {to_center[0] - d[0] * middle, to_center[1] - d[1] * middle,
                                     to_center[2] - d[2] * middle};
    double squared = radius_squared - dot(perpendicular, perpendicular);
    if (!(squared >= 0.0)) return false;
    double half = sqrt(squared * per_length_squared), margin = group->slack * query->per_length;
    if (middle - half > t_min) *enter = middle - half;
    *leave = least(middle + half, *leave);
    return *enter - margin <= *leave + margin;
}

/* Computes Embree's ray for a group: of unit direction, from its entry into the ball around the
 * group to its exit or the first hit so far. Returns false if that interval is empty, or if the ray
 * is invalid. */
static bool embree_ray(Query *query, const PsGroup *group, struct RTCRay *ray) {
    const double *o = query->origin, *d = query->direction;
    if (!is_valid(query->ray)) return false;
    double enter = query->ray->t_min, leave = least(query->t, query->ray->t_max), until = leave;
    if (!clip(query, group, &enter, &leave)) return false;
    query->start = enter - group->slack * query->per_length;
    query->slack = group->slack;
    query->certain_from = search_until(query, query->ray->t_min);
    query->certain_until = search_until(query, until) - 3.0f * (float)group->slack;
    float origin[3], direction[3];
    for (int axis = 0; axis < 3; axis++) {
        origin[axis] = (float)(o[axis] + d[axis] * query->start);
        direction[axis] = (float)(d[axis] * query->per_length);
    }
    *ray = (struct RTCRay){
        .org_x = origin[0],
        .org_y = origin[1],
        .org_z = origin[2],
        .tnear = 0.0f,
        .dir_x = direction[0],
        .dir_y = direction[1],
        .dir_z = direction[2],
        .tfar = search_until(query, leave),
        .mask = UINT32_MAX,
    };
    /* Rounding may leave nothing of a shortest interval; Embree does not touch such a ray. */
    return ray->tfar >= 0.0f;
}

/* Rays prepared together, so that the arithmetic of one fills the latencies of another. */
enum { BATCH = 16 };

static void closest_batch(const PsTarget *targets, size_t target_count, const PsRay *rays,
                          size_t count, PsHit *hits) {
    Query queries[BATCH];
    struct RTCRayHit rayhits[BATCH];
    bool is_live[BATCH];
    for (size_t i = 0; i < count; i++) begin(&queries[i], &rays[i]);
    for (const PsTarget *target = targets; target < targets + target_count; target++) {
        for (size_t i = 0; i < count; i++)
            is_live[i] = embree_ray(&queries[i], target->group, &rayhits[i].ray);
        for (size_t i = 0; i < count; i++) {
            if (!is_live[i]) continue;
            rayhits[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rayhits[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            trace_closest((RTCScene)target->scene, &queries[i], &rayhits[i]);
        }
        for (size_t i = 0; i < count; i++) settle(&queries[i], target->group);
    }
    for (size_t i = 0; i < count; i++)
        hits[i] = (PsHit){.t = (float)queries[i].t, .id = queries[i].id};
}

static void occluded_batch(const PsTarget *targets, size_t target_count, const PsRay *rays,
                           size_t count, bool *occluded) {
    Query queries[BATCH];
    struct RTCRay embree_rays[BATCH];
    bool is_live[BATCH];
    for (size_t i = 0; i < count; i++) {
        begin(&queries[i], &rays[i]);
        occluded[i] = false;
    }
    for (const PsTarget *target = targets; target < targets + target_count; target++) {
        for (size_t i = 0; i < count; i++)
            is_live[i] =
                !occluded[i] && embree_ray(&queries[i], target->group, &embree_rays[i]);
        for (size_t i = 0; i < count; i++) {
            if (!is_live[i]) continue;
            trace_occluded((RTCScene)target->scene, &queries[i], &embree_rays[i]);
            occluded[i] = embree_rays[i].tfar < 0.0f;
        }
    }
}

static size_t batch_size(size_t left) { return left < BATCH ? left : BATCH; }

void ps_closest(const PsTarget *targets, size_t target_count, const PsRay *rays, size_t count,
                PsHit *hits) {
    for (size_t i = 0; i < count; i += BATCH)
        closest_batch(targets, target_count, rays + i, batch_size(count - i), hits + i);
}

void ps_occluded(const PsTarget *targets, size_t target_count, const PsRay *rays, size_t count,
                 bool *occluded) {
    for (size_t i = 0; i < count; i += BATCH)
        occluded_batch(targets, target_count, rays + i, batch_size(count - i), occluded + i);
}
