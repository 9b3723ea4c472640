// Embree's build and single rays, on one thread, over spheres or a mesh and rays that `cargo bench --bench bvh` writes.
//
//     g++ -O3 -march=native -o embree_rays benches/peers/embree_rays.cpp -lembree3
//     ./embree_rays FILE
//
// FILE contains 32-bit numbers in native byte order: the number of spheres; x, y, z, radius of each; the number of
// vertices, and x, y, z of each; the number of triangles, and the numbers of the three corners of each; then,
// for each set of rays until the end, the number of rays; origin and direction of each. Prints the CPU seconds
// of the build, then for each set those of all its rays, one call of rtcIntersect1 each, and the number of hits.

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
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        size_t hits = 0;
        start = now();
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
        printf("%.9f %zu\n", now() - start, hits);
    }
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) return 1;
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
}
