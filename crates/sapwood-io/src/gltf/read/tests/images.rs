//! Images that are none, and those that would take too much.

use super::*;

/// A document whose material has an image, which is `image`.
fn with_image(image: Value) -> (Value, Vec<u8>) {
    let (mut document, bin) = triangle();
    set(&mut document, "/meshes/0/primitives/0/material", json!(0));
    let texture = json!({ "baseColorTexture": { "index": 0 } });
    document["materials"] = json!([{ "pbrMetallicRoughness": texture }]);
    document["textures"] = json!([{ "source": 0 }]);
    document["images"] = json!([image]);
    (document, bin)
}

#[test]
fn images_must_be_images() {
    let check = |image: Value, expected: &str| {
        let (document, bin) = with_image(image);
        assert_eq!(read_both(&document, &bin).unwrap_err().to_string(), expected);
    };
    let accepted = "(accepted: a PNG or JPEG image)";
    let told = format!("images[0]: 36 bytes that begin with [00, 00, 00, 00] {accepted}");
    check(json!({ "bufferView": 0 }), &told);
    check(json!({}), "images[0]: it has no bytes (accepted: a URI or a buffer view)");
    check(
        json!({ "uri": "data:image/png;base64,iVBOR!!" }),
        "images[0].uri: the data URI \"data:image/png;base64,iVBOR!!\" is not valid Base64 \
         (accepted: a data URI in Base64)",
    );
    check(
        json!({ "uri": "data:image/png;base64" }),
        "images[0].uri: the data URI \"data:image/png;base64\" has no comma (accepted: a data URI \
         in Base64)",
    );
    let told = format!("images[0]: no bytes {accepted}");
    check(json!({ "uri": "data:," }), &told);
    check(
        json!({ "uri": "a.png" }),
        "images[0].uri: the model has no folder (accepted: a data URI)",
    );
    let (mut document, bin) = with_image(json!({ "bufferView": 0 }));
    set(&mut document, "/textures/0/source", json!(1));
    let told = "textures[0].source: images[1] is not there (accepted: 0 to 0)";
    assert_eq!(read_both(&document, &bin).unwrap_err().to_string(), told);
}

#[test]
fn image_bombs_are_refused_by_their_headers() {
    let mut png = crate::png::png_bytes(
        &sapwood_geom::Image::from_fn(1, 1, |_, _| [9; 4]),
        crate::png::Packing::Fast,
    )
    .unwrap();
    png[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    let sum = crate::raster::check_sum(&png[12..29]);
    png[29..33].copy_from_slice(&sum.to_be_bytes());
    let (mut document, mut bin) = with_image(json!({}));
    let accessor = add(&mut document, &mut bin, (5121, "SCALAR", png.len()), &png);
    document["images"] = json!([{ "bufferView": accessor }]);
    let n = png.len();
    let told = format!("images[0]: not valid PNG: {n} bytes cannot hold 65536 x 65536 pixels");
    let error = read_both(&document, &bin).unwrap_err().to_string();
    assert_eq!(error, format!("{told} (accepted: a PNG or JPEG image)"));
    // Many small ones count together.
    let (mut document, bin) = with_image(json!({}));
    let png = crate::png::png_bytes(
        &sapwood_geom::Image::from_fn(8, 8, |x, _| [x as u8; 4]),
        crate::png::Packing::Fast,
    )
    .unwrap();
    let mut bin = bin;
    let view = add(&mut document, &mut bin, (5121, "SCALAR", png.len()), &png);
    document["images"] = json!([{ "bufferView": view }, { "bufferView": view }]);
    document["textures"] = json!([{ "source": 0 }, { "source": 1 }]);
    set(&mut document, "/materials/0/emissiveTexture", json!({ "index": 1 }));
    let limits = ReadLimits { pixels: 127, ..ReadLimits::default() };
    let error = read(&glb(&document, &bin), None, &limits).unwrap_err();
    let told = "images[1]: 128 pixels in all images of the scene; at most 127 are read";
    assert_eq!(error.to_string(), told);
}
