/* A Vulkan layer for tests: makes any driver look like one below what splitsum needs. The environment variable SPLITSUM_TEST_DRIVER
 * says how: "1.2" offers that version only, "no-synchronization2" lacks the feature. The few declarations of the loader's interface
 * that it takes are written out here, so that building it needs a C compiler and no Vulkan headers. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

typedef void (*Function)(void);
typedef Function (*GetInstanceProcAddr)(void *instance, const char *name);
typedef int (*CreateInstance)(const void *info, const void *allocator, void **instance);
typedef void (*GetProperties)(void *device, void *properties);

/* VkBaseInStructure, also the begin of VkLayerInstanceCreateInfo. */
typedef struct Chain {
    uint32_t type;
    struct Chain *next;
} Chain;

typedef struct Link {
    struct Link *next;
    GetInstanceProcAddr get_instance_proc_addr;
} Link;

typedef struct {
    Chain chain;
    uint32_t function;
    Link *link;
} LayerCreateInfo;

typedef struct {
    uint32_t type;
    void *next;
    uint32_t version;
    GetInstanceProcAddr get_instance_proc_addr;
    void *get_device_proc_addr;
    void *get_physical_device_proc_addr;
} NegotiateInterface;

enum { LOADER_INSTANCE_CREATE_INFO = 47, VULKAN_1_3_FEATURES = 53, LINK_INFO = 0, SYNCHRONIZATION2 = 9 };

static GetInstanceProcAddr next_get;
static GetProperties next_properties, next_properties2, next_features2;

static int wants(const char *what) {
    const char *fault = getenv("SPLITSUM_TEST_DRIVER");
    return fault && !strcmp(fault, what);
}

/* The version is the first field of VkPhysicalDeviceProperties. */
static void lower(void *properties) {
    if (wants("1.2")) *(uint32_t *)properties = 1u << 22 | 2u << 12;
}

static void properties(void *device, void *out) {
    next_properties(device, out);
    lower(out);
}

static void properties2(void *device, void *out) {
    next_properties2(device, out);
    lower((Chain *)out + 1);
}

static void features2(void *device, void *out) {
    next_features2(device, out);
    for (Chain *chain = out; chain; chain = chain->next)
        if (chain->type == VULKAN_1_3_FEATURES && wants("no-synchronization2"))
            ((uint32_t *)(chain + 1))[SYNCHRONIZATION2] = 0;
}

static int create_instance(const void *info, const void *allocator, void **instance) {
    LayerCreateInfo *own = (LayerCreateInfo *)((const Chain *)info)->next;
    while (own && !(own->chain.type == LOADER_INSTANCE_CREATE_INFO && own->function == LINK_INFO))
        own = (LayerCreateInfo *)own->chain.next;
    if (!own) return -3; /* VK_ERROR_INITIALIZATION_FAILED */
    next_get = own->link->get_instance_proc_addr;
    own->link = own->link->next;
    int result = ((CreateInstance)next_get(NULL, "vkCreateInstance"))(info, allocator, instance);
    if (result) return result;
    /* Now: later the loader would answer with the functions of this layer. */
    next_properties = (GetProperties)next_get(*instance, "vkGetPhysicalDeviceProperties");
    next_properties2 = (GetProperties)next_get(*instance, "vkGetPhysicalDeviceProperties2");
    next_features2 = (GetProperties)next_get(*instance, "vkGetPhysicalDeviceFeatures2");
    return 0;
}

static Function get(void *instance, const char *name) {
    if (!strcmp(name, "vkGetInstanceProcAddr")) return (Function)get;
    if (!strcmp(name, "vkCreateInstance")) return (Function)create_instance;
    if (!strcmp(name, "vkGetPhysicalDeviceProperties")) return (Function)properties;
    if (!strcmp(name, "vkGetPhysicalDeviceProperties2")) return (Function)properties2;
    if (!strcmp(name, "vkGetPhysicalDeviceFeatures2")) return (Function)features2;
    return next_get ? next_get(instance, name) : NULL;
}

EXPORT int vkNegotiateLoaderLayerInterfaceVersion(NegotiateInterface *interface) {
    interface->version = 2;
    interface->get_instance_proc_addr = get;
    interface->get_device_proc_addr = NULL;
    interface->get_physical_device_proc_addr = NULL;
    return 0;
}
