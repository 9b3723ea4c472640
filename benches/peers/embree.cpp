// Embree, to compare with Strahl: embree SPHERES.npy perspective|orthographic|lit RUNS [OUT.ppm]
//
// Builds a scene of spheres, then traces one ray for each pixel on one thread, one ray at a time
// and in packets of 4, 8 and 16, and prints the times as a line of JSON. `lit` is the perspective
// camera; each packet then also traces rays to the light from its hits that face it. OUT.ppm shows
// the hits, lit or not, to be compared with Strahl's picture. Everything is set up to be as fast as possible for
// Embree; see README.md.

#include "view.h" // Written by scenes.rs.

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

constexpr uint32_t NOTHING = RTC_INVALID_GEOMETRY_ID;
constexpr int PLANE_COUNT = sizeof(PLANES) / sizeof(PLANES[0]);
// Pixels are visited in square tiles of this side, so that neighbors share caches.
constexpr int TILE = 8;
static_assert(WIDTH % TILE == 0 && HEIGHT % TILE == 0);

[[noreturn]] static void fail(const std::string &message) {
    std::fprintf(stderr, "error: %s\n", message.c_str());
    std::exit(1);
}

// CPU seconds of this process: with one thread, the elapsed time without that of other processes.
static double now() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return double(time.tv_sec) + double(time.tv_nsec) * 1e-9;
}

static double median(std::vector<double> times) {
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

// Center and radius of each sphere for Embree, and the color for the picture.
struct Spheres {
    std::vector<float> points;
    std::vector<double> colors;
};

// What a pixel sees: a plane, or a sphere after all planes; and the cosine that lights it.
struct Pixel {
    uint32_t index;
    float light;
};

// Reads a file written by scenes.rs: rows of x y z radius r g b as f64.
static Spheres read(const char *path) {
    FILE *file = std::fopen(path, "rb");
    unsigned char head[10];
    if (!file || std::fread(head, 1, 10, file) != 10 || std::memcmp(head, "\x93NUMPY\x01", 7) != 0)
        fail(std::string(path) + " is not a table of spheres");
    std::fseek(file, 10 + head[8] + 256 * head[9], SEEK_SET);
    Spheres spheres;
    double row[7];
    while (std::fread(row, sizeof row, 1, file) == 1) {
        for (int i = 0; i < 4; i++)
            spheres.points.push_back(float(row[i]));
        spheres.colors.insert(spheres.colors.end(), row + 4, row + 7);
    }
    std::fclose(file);
    return spheres;
}

static RTCScene build(RTCDevice device, Spheres &spheres) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                               spheres.points.data(), 0, 16, spheres.points.size() / 4);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

// The rays of a camera; the direction need not have length 1 for Embree. Pixel (x, y) counts from
// the bottom left. Both cameras look along -z with up = y, so that u = x and v = y.
struct Camera {
    bool perspective;
    float columns[WIDTH], rows[HEIGHT];

    explicit Camera(bool perspective) : perspective(perspective) {
        double depth = (HEIGHT / 2.0) / std::tan(FOV / 2 * (std::acos(-1.0) / 180));
        double step = perspective ? 1 / depth : SCALE / (HEIGHT - 1);
        double right = perspective ? 0 : EYE[0], up = perspective ? 0 : EYE[1];
        for (int x = 0; x < WIDTH; x++)
            columns[x] = float(right + step * (x - (WIDTH - 1) / 2.0));
        for (int y = 0; y < HEIGHT; y++)
            rows[y] = float(up + step * (y - (HEIGHT - 1) / 2.0));
    }
};

template <int N> struct Packet;
template <> struct Packet<4> {
    using Type = RTCRayHit4;
    using Shadow = RTCRay4;
    static constexpr auto intersect = rtcIntersect4;
    static constexpr auto occluded = rtcOccluded4;
};
template <> struct Packet<8> {
    using Type = RTCRayHit8;
    using Shadow = RTCRay8;
    static constexpr auto intersect = rtcIntersect8;
    static constexpr auto occluded = rtcOccluded8;
};
template <> struct Packet<16> {
    using Type = RTCRayHit16;
    using Shadow = RTCRay16;
    static constexpr auto intersect = rtcIntersect16;
    static constexpr auto occluded = rtcOccluded16;
};

// The nearest plane, tested before the spheres, so that Embree need not look behind it.
struct Nearest {
    float t;
    uint32_t index;
};

enum class View { PERSPECTIVE, ORTHOGRAPHIC, LIT };

template <bool PERSPECTIVE> static inline Nearest plane_hit(float column, float row) {
    Nearest nearest{std::numeric_limits<float>::infinity(), NOTHING};
    for (int plane = 0; plane < PLANE_COUNT; plane++) {
        const auto &[a, n, color] = PLANES[plane];
        float dot, gap;
        if (PERSPECTIVE) {
            dot = column * float(n[0]) + row * float(n[1]) - float(n[2]);
            gap = float((a[0] - EYE[0]) * n[0] + (a[1] - EYE[1]) * n[1] + (a[2] - EYE[2]) * n[2]);
        } else {
            dot = -float(n[2]);
            gap = (float(a[0]) - column) * float(n[0]) + (float(a[1]) - row) * float(n[1])
                + float((a[2] - EYE[2]) * n[2]);
        }
        float t = gap / dot;
        bool nearer = t > 0 && t < nearest.t;
        nearest = {nearer ? t : nearest.t, nearer ? uint32_t(plane) : nearest.index};
    }
    return nearest;
}

static const RTCIntersectContext COHERENT = [] {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
}();

// Calls work(x, y) for the lower left corner of every block of a packet, tile by tile.
template <int W, int H, typename Work> static void for_blocks(Work work) {
    for (int top = 0; top < HEIGHT; top += TILE)
        for (int left = 0; left < WIDTH; left += TILE)
            for (int y = top; y < top + TILE; y += H)
                for (int x = left; x < left + TILE; x += W)
                    work(x, y);
}

// A ray from a surface to the light, whose t is 1.
struct ToLight {
    float origin[3], direction[3];
    // Of the angle between the normal and the direction.
    float cosine;

    ToLight(float x, float y, float z, const float *normal) : origin{x, y, z} {
        float across = 0, n2 = 0, d2 = 0;
        for (int axis = 0; axis < 3; axis++) {
            direction[axis] = float(LIGHT[axis]) - origin[axis];
            across += normal[axis] * direction[axis];
            n2 += normal[axis] * normal[axis];
            d2 += direction[axis] * direction[axis];
        }
        cosine = across / std::sqrt(n2 * d2);
    }
};
// A ray starts here so that it does not hit the sphere that it leaves. No plane is in the way of the light.
constexpr float SHADOW_NEAR = 1e-5f;

// One ray at a time.
template <View VIEW>
static void trace_single(RTCScene scene, const Camera &camera, Pixel *pixels) {
    constexpr bool PERSPECTIVE = VIEW != View::ORTHOGRAPHIC;
    RTCIntersectContext context = COHERENT;
    for_blocks<1, 1>([&](int x, int y) {
        float column = camera.columns[x], row = camera.rows[y];
        Nearest plane = plane_hit<PERSPECTIVE>(column, row);
        RTCRayHit it;
        it.ray.org_x = PERSPECTIVE ? float(EYE[0]) : column;
        it.ray.org_y = PERSPECTIVE ? float(EYE[1]) : row;
        it.ray.org_z = float(EYE[2]);
        it.ray.dir_x = PERSPECTIVE ? column : 0;
        it.ray.dir_y = PERSPECTIVE ? row : 0;
        it.ray.dir_z = -1;
        it.ray.tnear = 0;
        it.ray.tfar = plane.t;
        it.ray.time = 0;
        it.ray.mask = ~0u;
        it.ray.flags = 0;
        it.hit.geomID = it.hit.instID[0] = NOTHING;
        rtcIntersect1(scene, &context, &it);
        bool is_sphere = it.hit.geomID != NOTHING;
        float light = 1;
        if (VIEW == View::LIT) {
            const double *flat = PLANES[is_sphere ? 0 : plane.index][1];
            float normal[3] = {is_sphere ? it.hit.Ng_x : float(flat[0]), is_sphere ? it.hit.Ng_y : float(flat[1]),
                               is_sphere ? it.hit.Ng_z : float(flat[2])};
            float t = it.ray.tfar;
            ToLight to(it.ray.org_x + t * column, it.ray.org_y + t * row, it.ray.org_z - t, normal);
            light = std::max(0.0f, to.cosine);
            if (to.cosine > 0) {
                RTCRay shadow;
                shadow.org_x = to.origin[0];
                shadow.org_y = to.origin[1];
                shadow.org_z = to.origin[2];
                shadow.dir_x = to.direction[0];
                shadow.dir_y = to.direction[1];
                shadow.dir_z = to.direction[2];
                shadow.tnear = SHADOW_NEAR;
                shadow.tfar = 1;
                shadow.time = 0;
                shadow.mask = ~0u;
                shadow.flags = 0;
                rtcOccluded1(scene, &context, &shadow);
                light = shadow.tfar < 0 ? 0 : light;
            }
        }
        pixels[y * WIDTH + x] = {is_sphere ? PLANE_COUNT + it.hit.primID : plane.index, light};
    });
}

// N rays at a time, a block of W times H pixels.
template <View VIEW, int N, int W>
static void trace_packets(RTCScene scene, const Camera &camera, Pixel *pixels) {
    constexpr bool PERSPECTIVE = VIEW != View::ORTHOGRAPHIC;
    RTCIntersectContext context = COHERENT;
    alignas(64) int valid[N];
    std::fill(valid, valid + N, -1);
    for_blocks<W, N / W>([&](int x, int y) {
        typename Packet<N>::Type it;
        uint32_t planes[N];
        for (int i = 0; i < N; i++) {
            float column = camera.columns[x + i % W], row = camera.rows[y + i / W];
            Nearest plane = plane_hit<PERSPECTIVE>(column, row);
            planes[i] = plane.index;
            it.ray.org_x[i] = PERSPECTIVE ? float(EYE[0]) : column;
            it.ray.org_y[i] = PERSPECTIVE ? float(EYE[1]) : row;
            it.ray.org_z[i] = float(EYE[2]);
            it.ray.dir_x[i] = PERSPECTIVE ? column : 0;
            it.ray.dir_y[i] = PERSPECTIVE ? row : 0;
            it.ray.dir_z[i] = -1;
            it.ray.tnear[i] = 0;
            it.ray.tfar[i] = plane.t;
            it.ray.time[i] = 0;
            it.ray.mask[i] = ~0u;
            it.ray.flags[i] = 0;
            it.hit.geomID[i] = it.hit.instID[0][i] = NOTHING;
        }
        Packet<N>::intersect(valid, scene, &context, &it);
        float lights[N];
        std::fill(lights, lights + N, 1.0f);
        if (VIEW == View::LIT) {
            typename Packet<N>::Shadow shadow;
            alignas(64) int faces[N];
            for (int i = 0; i < N; i++) {
                bool is_sphere = it.hit.geomID[i] != NOTHING;
                const double *flat = PLANES[is_sphere ? 0 : planes[i]][1];
                float normal[3] = {is_sphere ? it.hit.Ng_x[i] : float(flat[0]),
                                   is_sphere ? it.hit.Ng_y[i] : float(flat[1]),
                                   is_sphere ? it.hit.Ng_z[i] : float(flat[2])};
                float t = it.ray.tfar[i];
                ToLight to(it.ray.org_x[i] + t * it.ray.dir_x[i], it.ray.org_y[i] + t * it.ray.dir_y[i],
                           it.ray.org_z[i] + t * it.ray.dir_z[i], normal);
                faces[i] = to.cosine > 0 ? -1 : 0;
                lights[i] = std::max(0.0f, to.cosine);
                shadow.org_x[i] = to.origin[0];
                shadow.org_y[i] = to.origin[1];
                shadow.org_z[i] = to.origin[2];
                shadow.dir_x[i] = to.direction[0];
                shadow.dir_y[i] = to.direction[1];
                shadow.dir_z[i] = to.direction[2];
                shadow.tnear[i] = SHADOW_NEAR;
                shadow.tfar[i] = 1;
                shadow.time[i] = 0;
                shadow.mask[i] = ~0u;
                shadow.flags[i] = 0;
            }
            Packet<N>::occluded(faces, scene, &context, &shadow);
            for (int i = 0; i < N; i++)
                lights[i] = shadow.tfar[i] < 0 ? 0 : lights[i];
        }
        for (int i = 0; i < N; i++)
            pixels[(y + i / W) * WIDTH + x + i % W] = {
                it.hit.geomID[i] == NOTHING ? planes[i] : PLANE_COUNT + it.hit.primID[i], lights[i]};
    });
}

template <View VIEW> static void trace(int width, RTCScene scene, const Camera &camera, Pixel *pixels) {
    switch (width) {
    case 1: return trace_single<VIEW>(scene, camera, pixels);
    case 4: return trace_packets<VIEW, 4, 2>(scene, camera, pixels);
    case 8: return trace_packets<VIEW, 8, 4>(scene, camera, pixels);
    default: return trace_packets<VIEW, 16, 4>(scene, camera, pixels);
    }
}

// Display values of a channel lit by a cosine.
static double shown(double channel, float light) {
    if (light == 1)
        return channel;
    double l = (channel <= 0.04045 ? channel / 12.92 : std::pow((channel + 0.055) / 1.055, 2.4)) * light;
    return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
}

static void write_ppm(const char *path, const Pixel *pixels, const Spheres &spheres) {
    std::vector<double> colors;
    for (const auto &plane : PLANES)
        colors.insert(colors.end(), plane[2], plane[2] + 3);
    colors.insert(colors.end(), spheres.colors.begin(), spheres.colors.end());
    std::vector<uint8_t> bytes;
    for (int y = HEIGHT - 1; y >= 0; y--)
        for (int x = 0; x < WIDTH; x++) {
            Pixel pixel = pixels[y * WIDTH + x];
            for (int channel = 0; channel < 3; channel++) {
                double color = pixel.index == NOTHING ? 0 : colors[size_t(pixel.index) * 3 + channel];
                bytes.push_back(uint8_t(std::floor(shown(color, pixel.light) * 255 + 0.5)));
            }
        }
    FILE *file = std::fopen(path, "wb");
    if (!file)
        fail(std::string("cannot write ") + path);
    std::fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    std::fwrite(bytes.data(), 1, bytes.size(), file);
    std::fclose(file);
}

int main(int argc, char **argv) {
    if (argc < 4)
        fail("embree SPHERES.npy perspective|orthographic|lit RUNS [OUT.ppm]");
    bool perspective = std::strcmp(argv[2], "orthographic") != 0;
    bool lit = std::strcmp(argv[2], "lit") == 0;
    int runs = std::max(1, std::atoi(argv[3]));
    Spheres spheres = read(argv[1]);
    Camera camera(perspective);
    // Embree recommends both: denormal numbers are slow.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    RTCDevice device = rtcNewDevice("threads=1");
    if (!device)
        fail("Embree does not start");

    constexpr int WIDTHS[4] = {1, 4, 8, 16};
    std::vector<double> builds, traces[4], lights[4];
    std::vector<Pixel> pixels(size_t(WIDTH) * HEIGHT), first;
    for (int run = 0; run < runs; run++) {
        double start = now();
        RTCScene scene = build(device, spheres);
        builds.push_back(now() - start);
        for (int w = 0; w < 4; w++) {
            start = now();
            if (perspective)
                trace<View::PERSPECTIVE>(WIDTHS[w], scene, camera, pixels.data());
            else
                trace<View::ORTHOGRAPHIC>(WIDTHS[w], scene, camera, pixels.data());
            traces[w].push_back(now() - start);
            if (lit) {
                start = now();
                trace<View::LIT>(WIDTHS[w], scene, camera, pixels.data());
                lights[w].push_back(now() - start);
            }
            if (first.empty())
                first = pixels;
        }
        rtcReleaseScene(scene);
    }
    if (RTCError error = rtcGetDeviceError(device))
        fail("Embree reports error " + std::to_string(error));
    rtcReleaseDevice(device);

    double best = std::numeric_limits<double>::infinity(), best_lit = best;
    std::printf("{\"spheres\": %zu, \"runs\": %d, \"build_s\": %.6f, \"build_min_s\": %.6f", spheres.points.size() / 4,
                runs, median(builds), *std::min_element(builds.begin(), builds.end()));
    for (int w = 0; w < 4; w++) {
        std::printf(", \"trace%d_s\": %.6f, \"trace%d_min_s\": %.6f", WIDTHS[w], median(traces[w]), WIDTHS[w],
                    *std::min_element(traces[w].begin(), traces[w].end()));
        best = std::min(best, median(traces[w]));
        if (lit)
            best_lit = std::min(best_lit, median(lights[w]));
    }
    std::printf(", \"trace_s\": %.6f", best);
    if (lit)
        std::printf(", \"shadow_s\": %.6f", best_lit - best);
    std::printf("}\n");
    if (argc > 4)
        write_ppm(argv[4], first.data(), spheres);
}
