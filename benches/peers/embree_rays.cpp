// Embree's build, single rays and packets, on one thread, over spheres or a mesh and rays that `cargo bench --bench bvh` writes.
//
//     g++ -O3 -march=native -o embree_rays benches/peers/embree_rays.cpp -lembree3
//     ./embree_rays FILE
//
// FILE contains 32-bit numbers in native byte order: the number of spheres; x, y, z, radius of each; the number of
// vertices, and x, y, z of each; the number of triangles, and the numbers of the three corners of each; then,
// for each set of rays until the end, the number of rays; origin and direction of each. Prints the CPU seconds
// of the build, then for each set those of all its rays, one call of rtcIntersect1 each, then 4, 8 and 16 at a time
// in packets of coherent rays, and the number of hits.

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <ctime>
#include <vector>

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

// CPU seconds of this process, without those of other programs.
static double now() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return time.tv_sec + time.tv_nsec * 1e-9;
}

template <int N> struct Packet;
template <> struct Packet<4> {
    using Type = RTCRayHit4;
    static constexpr auto intersect = rtcIntersect4;
};
template <> struct Packet<8> {
    using Type = RTCRayHit8;
    static constexpr auto intersect = rtcIntersect8;
};
template <> struct Packet<16> {
    using Type = RTCRayHit16;
    static constexpr auto intersect = rtcIntersect16;
};

static double trace_single(RTCScene scene, const std::vector<float> &rays, size_t &hits) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    double start = now();
    for (const float *ray = rays.data(); ray != rays.data() + rays.size(); ray += 6) {
        RTCRayHit query;
        query.ray.org_x = ray[0], query.ray.org_y = ray[1], query.ray.org_z = ray[2];
        query.ray.dir_x = ray[3], query.ray.dir_y = ray[4], query.ray.dir_z = ray[5];
        query.ray.tnear = 0, query.ray.tfar = std::numeric_limits<float>::infinity();
        query.ray.time = 0, query.ray.mask = ~0u, query.ray.id = 0, query.ray.flags = 0;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID, query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &query);
        hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return now() - start;
}

// N rays at a time, in the order of the set.
template <int N> static double trace_packets(RTCScene scene, const std::vector<float> &rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(64) int valid[N];
    double start = now();
    const float *end = rays.data() + rays.size();
    for (const float *ray = rays.data(); ray < end;) {
        typename Packet<N>::Type query;
        for (int i = 0; i < N; i++) {
            valid[i] = ray < end ? -1 : 0;
            if (!valid[i]) continue;
            query.ray.org_x[i] = ray[0], query.ray.org_y[i] = ray[1], query.ray.org_z[i] = ray[2];
            query.ray.dir_x[i] = ray[3], query.ray.dir_y[i] = ray[4], query.ray.dir_z[i] = ray[5];
            query.ray.tnear[i] = 0, query.ray.tfar[i] = std::numeric_limits<float>::infinity();
            query.ray.time[i] = 0, query.ray.mask[i] = ~0u, query.ray.id[i] = 0, query.ray.flags[i] = 0;
            query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID, query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
            ray += 6;
        }
        Packet<N>::intersect(valid, scene, &context, &query);
    }
    return now() - start;
}

static bool read_rows(FILE *file, size_t width, std::vector<float> &rows) {
    uint32_t count;
    if (fread(&count, sizeof count, 1, file) != 1) return false;
    rows.resize(count * width);
    return fread(rows.data(), sizeof(float), rows.size(), file) == rows.size();
}

int main(int argc, char **argv) {
    FILE *file = argc == 2 ? fopen(argv[1], "rb") : nullptr;
    std::vector<float> spheres, vertices, triangles;
    if (!file || !read_rows(file, 4, spheres) || !read_rows(file, 3, vertices) || !read_rows(file, 3, triangles)) {
        fprintf(stderr, "usage: embree_rays FILE\n");
        return 2;
    }
    std::vector<std::vector<float>> sets;
    for (std::vector<float> rays; read_rows(file, 6, rays);) sets.push_back(rays);

    // Recommended by Embree's manual for programs that trace rays.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);

    RTCDevice device = rtcNewDevice("threads=1,user_threads=1");
    RTCScene scene = rtcNewScene(device);
    bool is_mesh = spheres.empty();
    RTCGeometry geometry = rtcNewGeometry(device, is_mesh ? RTC_GEOMETRY_TYPE_TRIANGLE : RTC_GEOMETRY_TYPE_SPHERE_POINT);
    // The numbers of corners have been read as the bits of floats.
    auto fill = [&](RTCBufferType type, RTCFormat format, size_t width, const std::vector<float> &rows) {
        size_t size = width * sizeof(float);
        void *buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, size, rows.size() / width);
        memcpy(buffer, rows.data(), rows.size() * sizeof(float));
    };
    if (is_mesh) {
        fill(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3, vertices);
        fill(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 3, triangles);
    } else {
        fill(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4, spheres);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    double start = now();
    rtcCommitScene(scene);
    printf("%.9f\n", now() - start);

    for (const std::vector<float> &rays : sets) {
        size_t hits = 0;
        double single = trace_single(scene, rays, hits);
        double packets[] = {trace_packets<4>(scene, rays), trace_packets<8>(scene, rays), trace_packets<16>(scene, rays)};
        printf("%.9f %.9f %.9f %.9f %zu\n", single, packets[0], packets[1], packets[2], hits);
    }
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) return 1;
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
}
