#include "renderer/scene/conductor_presets.h"

#include <array>

#include "renderer/base/names.h"

namespace misbench {
namespace {

// Measured spectra (E. D. Palik, Handbook of optical constants of solids, 1998, and the Center for
// X-Ray Optics) as linear sRGB: integrated over 360 to 830 nm with the CIE 1931 matching functions,
// and what is negative then is 0. The numbers are the parameters eta and k that Mitsuba 3.9.1
// derives, variant scalar_rgb; images are compared with its. "none" reflects everything.
constexpr std::array kPresets = {
    ConductorPreset{
        "Ag", {0.1552762F, 0.116727956F, 0.13838764F}, {4.8283544F, 3.1222224F, 2.1469011F}},
    ConductorPreset{"Al", {1.6575009F, 0.8804047F, 0.52124447F}, {9.223811F, 6.269502F, 4.837004F}},
    ConductorPreset{"AlAs", {3.605296F, 3.2329378F, 2.2163186F}, {6.794373e-4F, 0, 0.007512709F}},
    ConductorPreset{
        "AlAs_palik", {3.605296F, 3.2329378F, 2.2163186F}, {6.794373e-4F, 0, 0.007512709F}},
    ConductorPreset{"AlSb", {0, 4.1393747F, 4.6692543F}, {0, 0.09400908F, 1.30057F}},
    ConductorPreset{"AlSb_palik", {0, 4.1393747F, 4.6692543F}, {0, 0.09400908F, 1.30057F}},
    ConductorPreset{
        "Au", {0.14303598F, 0.37530708F, 1.4420453F}, {3.982997F, 2.3855565F, 1.6033592F}},
    ConductorPreset{"Be", {4.1850123F, 3.1850293F, 2.7840612F}, {3.835466F, 3.0101223F, 2.868994F}},
    ConductorPreset{
        "Be_palik", {4.1850123F, 3.1850293F, 2.7840612F}, {3.835466F, 3.0101223F, 2.868994F}},
    ConductorPreset{"Cr", {4.3696675F, 2.9165053F, 1.6549046F}, {5.206547F, 4.231306F, 3.7546988F}},
    ConductorPreset{"CsI", {2.1448996F, 1.7023189F, 1.6624272F}, {0, 0, 0}},
    ConductorPreset{"CsI_palik", {2.1448996F, 1.7023189F, 1.6624272F}, {0, 0, 0}},
    ConductorPreset{
        "Cu", {0.20100547F, 0.9237495F, 1.1022154F}, {3.9132621F, 2.4530451F, 2.1420898F}},
    ConductorPreset{
        "Cu2O", {3.5517726F, 2.9498696F, 2.7518754F}, {0.11420702F, 0.19389686F, 0.6061339F}},
    ConductorPreset{
        "Cu2O_palik", {3.5517726F, 2.9498696F, 2.7518754F}, {0.11420702F, 0.19389686F, 0.6061339F}},
    ConductorPreset{
        "CuO", {3.247541F, 2.4478052F, 2.2102196F}, {0.52108955F, 0.57003075F, 0.72217894F}},
    ConductorPreset{
        "CuO_palik", {3.247541F, 2.4478052F, 2.2102196F}, {0.52108955F, 0.57003075F, 0.72217894F}},
    ConductorPreset{
        "Cu_palik", {0.21322851F, 0.9197154F, 1.1024108F}, {3.9218733F, 2.4573317F, 2.136584F}},
    ConductorPreset{"Hg", {2.3989387F, 1.440028F, 0.9095704F}, {6.327587F, 4.371925F, 3.4217637F}},
    ConductorPreset{
        "HgTe", {4.77904F, 3.2311962F, 2.6599011F}, {1.6316127F, 1.5808104F, 1.7292874F}},
    ConductorPreset{
        "HgTe_palik", {4.77904F, 3.2311962F, 2.6599011F}, {1.6316127F, 1.5808104F, 1.7292874F}},
    ConductorPreset{
        "Hg_palik", {2.3989387F, 1.440028F, 0.9095704F}, {6.327587F, 4.371925F, 3.4217637F}},
    ConductorPreset{"Ir", {3.0863F, 2.0821905F, 1.6179146F}, {5.592153F, 4.067088F, 3.267312F}},
    ConductorPreset{
        "Ir_palik", {3.0863F, 2.0821905F, 1.6179146F}, {5.592153F, 4.067088F, 3.267312F}},
    ConductorPreset{
        "K", {0.06404319F, 0.046409767F, 0.038184915F}, {2.1041996F, 1.34894F, 0.9131259F}},
    ConductorPreset{
        "K_palik", {0.06404319F, 0.046409767F, 0.038184915F}, {2.1041996F, 1.34894F, 0.9131259F}},
    ConductorPreset{
        "Li", {0.26579094F, 0.19561832F, 0.22094862F}, {3.540155F, 2.3111234F, 1.6686072F}},
    ConductorPreset{
        "Li_palik", {0.26579094F, 0.19561832F, 0.22094862F}, {3.540155F, 2.3111234F, 1.6686072F}},
    ConductorPreset{
        "MgO", {2.0895839F, 1.6507235F, 1.594879F}, {4.3326952e-12F, 0, 2.4986457e-11F}},
    ConductorPreset{
        "MgO_palik", {2.0895839F, 1.6507235F, 1.594879F}, {4.3326952e-12F, 0, 2.4986457e-11F}},
    ConductorPreset{"Mo", {4.483974F, 3.5251307F, 2.7763104F}, {4.1114373F, 3.420827F, 3.1506073F}},
    ConductorPreset{
        "Mo_palik", {4.483974F, 3.5251307F, 2.7763104F}, {4.1114373F, 3.420827F, 3.1506073F}},
    ConductorPreset{"Na_palik",
                    {0.060269356F, 0.056140948F, 0.061988432F},
                    {3.1792734F, 2.1124904F, 1.5790411F}},
    ConductorPreset{
        "Nb", {3.420074F, 2.7900932F, 2.3956294F}, {3.4413946F, 2.7376661F, 2.5797458F}},
    ConductorPreset{
        "Nb_palik", {3.420074F, 2.7900932F, 2.3956294F}, {3.4413946F, 2.7376661F, 2.5797458F}},
    ConductorPreset{
        "Ni_palik", {2.3673046F, 1.6633731F, 1.4670781F}, {4.4988117F, 3.050153F, 2.3454392F}},
    ConductorPreset{"Rh", {2.5857935F, 1.8602164F, 1.5542634F}, {6.7822604F, 4.702987F, 3.976073F}},
    ConductorPreset{
        "Rh_palik", {2.5857935F, 1.8602164F, 1.5542634F}, {6.7822604F, 4.702987F, 3.976073F}},
    ConductorPreset{
        "Se", {4.0583115F, 2.842935F, 2.8208535F}, {0.75404954F, 0.6384435F, 0.52180755F}},
    ConductorPreset{
        "Se-e", {5.722849F, 4.165736F, 4.0813384F}, {0.8711363F, 1.1051575F, 1.5653203F}},
    ConductorPreset{
        "Se-e_palik", {5.722849F, 4.165736F, 4.0813384F}, {0.8711363F, 1.1051575F, 1.5653203F}},
    ConductorPreset{
        "Se_palik", {4.0583115F, 2.842935F, 2.8208535F}, {0.75404954F, 0.6384435F, 0.52180755F}},
    ConductorPreset{
        "SiC", {3.1723416F, 2.5259717F, 2.4793706F}, {7.5376636e-07F, 0, 1.0192531e-05F}},
    ConductorPreset{
        "SiC_palik", {3.1723416F, 2.5259717F, 2.4793706F}, {7.5376636e-07F, 0, 1.0192531e-05F}},
    ConductorPreset{"SnTe", {4.5242496F, 1.981645F, 1.2815913F}, {0, 0, 0}},
    ConductorPreset{"SnTe_palik", {4.5242496F, 1.981645F, 1.2815913F}, {0, 0, 0}},
    ConductorPreset{
        "Ta", {2.062721F, 2.3929389F, 2.6279287F}, {2.4083598F, 1.7414864F, 1.9470278F}},
    ConductorPreset{
        "Ta_palik", {2.062721F, 2.3929389F, 2.6279287F}, {2.4083598F, 1.7414864F, 1.9470278F}},
    ConductorPreset{"Te", {7.3902335F, 4.482105F, 2.637106F}, {3.2560222F, 3.5270588F, 3.2920542F}},
    ConductorPreset{
        "Te-e", {7.508907F, 4.2964287F, 2.3699877F}, {5.5839286F, 4.947205F, 3.9975922F}},
    ConductorPreset{
        "Te-e_palik", {7.508907F, 4.2964287F, 2.3699877F}, {5.5839286F, 4.947205F, 3.9975922F}},
    ConductorPreset{
        "Te_palik", {7.3902335F, 4.482105F, 2.637106F}, {3.2560222F, 3.5270588F, 3.2920542F}},
    ConductorPreset{"ThF4", {1.8307136F, 1.4422286F, 1.3876476F}, {0, 0, 0}},
    ConductorPreset{"ThF4_palik", {1.8307136F, 1.4422286F, 1.3876476F}, {0, 0, 0}},
    ConductorPreset{
        "TiC", {3.7005284F, 2.8374221F, 2.582287F}, {3.265635F, 2.3515892F, 2.1727905F}},
    ConductorPreset{
        "TiC_palik", {3.7005284F, 2.8374221F, 2.582287F}, {3.265635F, 2.3515892F, 2.1727905F}},
    ConductorPreset{
        "TiN", {1.6484497F, 1.150516F, 1.3798234F}, {3.368328F, 1.9434981F, 1.1020677F}},
    ConductorPreset{
        "TiN_palik", {1.6484497F, 1.150516F, 1.3798234F}, {3.368328F, 1.9434981F, 1.1020677F}},
    ConductorPreset{"TiO2", {3.45661F, 2.8017359F, 2.905175F}, {1.0526484e-4F, 0, 6.528865e-4F}},
    ConductorPreset{
        "TiO2-e", {3.1065645F, 2.5131683F, 2.5824444F}, {2.9751605e-05F, 0, 1.8269809e-4F}},
    ConductorPreset{
        "TiO2-e_palik", {3.1065645F, 2.5131683F, 2.5824444F}, {2.9751605e-05F, 0, 1.8269809e-4F}},
    ConductorPreset{
        "TiO2_palik", {3.45661F, 2.8017359F, 2.905175F}, {1.0526484e-4F, 0, 6.528865e-4F}},
    ConductorPreset{"VC", {3.657566F, 2.752736F, 2.532672F}, {3.0683007F, 2.1986873F, 1.9631927F}},
    ConductorPreset{"VC_palik",
                    {3.657566F, 2.752736F, 2.532672F},
                    {3.0683007F, 2.1986873F, 1.9631927F}},
    ConductorPreset{
        "VN", {2.8656023F, 2.119189F, 1.9400911F}, {3.0322425F, 2.0561156F, 1.6163063F}},
    ConductorPreset{"VN_palik",
                    {2.8656023F, 2.119189F, 1.9400911F},
                    {3.0322425F, 2.0561156F, 1.6163063F}},
    ConductorPreset{
        "V_palik", {4.277582F, 3.5129488F, 2.7610714F}, {3.4913008F, 2.8894548F, 3.111522F}},
    ConductorPreset{"W", {4.3708167F, 3.3002465F, 2.9984074F}, {3.5006406F, 2.604874F, 2.2732332F}},
    ConductorPreset{
        "a-C", {2.9440458F, 2.2271364F, 1.9681617F}, {0.8874649F, 0.7992985F, 0.81529F}},
    ConductorPreset{"d-C", {2.7087197F, 2.3188257F, 2.2288976F}, {0, 0, 0}},
    ConductorPreset{"d-C_palik", {2.7087197F, 2.3188257F, 2.2288976F}, {0, 0, 0}},
    ConductorPreset{"none", {0, 0, 0}, {1, 1, 1}},
};

}  // namespace

const ConductorPreset& find_conductor_preset(const std::string& name) {
    return find_named(kPresets, name, "material", "conductor");
}

}  // namespace misbench
