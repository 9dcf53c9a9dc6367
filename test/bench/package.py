"""The reference package on the same pictures and the same network, in PyTorch.

    package.py NAME HEIGHT WIDTH PICTURE...

counts the pictures one by one and prints the peak of its memory, in bytes.
"""
import itertools
import resource
import sys
import time
from pathlib import Path

GOLDEN = Path(__file__).resolve().parents[1] / "golden"


def torch_network(torch, name):
    """(module, name of the counted output, neurons)"""
    sys.path.insert(0, str(GOLDEN))
    import make_export
    if name.startswith("cosplace"):
        return make_export.cosplace_resnet101(), "embedding", 128
    if name.startswith("mugs"):
        return make_export.mugs_vitb16(), "tokens", 768
    if name.startswith("mobilenet_v2"):
        from torchvision.models import mobilenet_v2
        network = mobilenet_v2(weights=None)
        return pooled(torch, network, network.features), "embedding", 1280
    from efficientnet_lite_pytorch import EfficientNet
    network = EfficientNet.from_name("efficientnet-lite0")
    return pooled(torch, network, network.extract_features), "embedding", 1280


def pooled(torch, network, features):
    """A network's last feature map, averaged."""
    class Pooled(torch.nn.Module):
        def __init__(self):
            super().__init__()
            self.network = network

        def forward(self, x):
            return {"embedding": features(x).mean((2, 3))}
    return Pooled()


class Package:
    """VDNAs of pictures by the package."""

    def __init__(self, torch, name, size, files, batches):
        """files: pictures; batches: candidate sizes for the fastest, on one thread or two: on a
        busy machine, PyTorch's threads wait for each other longer than they compute"""
        from vdna.networks import FeatureExtractionModel
        from vdna.utils.settings import DataSettings, ExtractionSettings, NetworkSettings
        module, output, neurons = torch_network(torch, name)
        module.eval()
        network = NetworkSettings([0.485, 0.456, 0.406], [0.229, 0.224, 0.225], {output: neurons},
                                  size, name)
        ranges = {key: {output: dict.fromkeys(range(neurons), value)}
                  for key, value in (("mins_per_neuron", -3.0), ("maxs_per_neuron", 3.0))}

        class Extractor(FeatureExtractionModel):
            def get_features(self, x):
                values = module(x)[output]
                values = values[:, None] if values.ndim == 2 else values
                return {output: values.permute(0, 2, 1).unsqueeze(3)}

        settings = ExtractionSettings(device="cpu", num_workers=0, verbose=False,
                                      n_sample_images=0)
        self._extractor = Extractor(network, settings, ranges)
        self._data_settings = DataSettings
        self._torch = torch
        self._files = [str(file) for file in (files * max(batches))[:max(batches)]]
        self._seconds(1, 1)
        self._setting = min(itertools.product(batches, (1, 2)), key=lambda s: self._seconds(*s))

    @property
    def name(self):
        """A name with the fastest setting."""
        return "vdna package, batches of {}, threads: {}".format(*self._setting)

    def seconds(self):
        """Time to count one picture."""
        return self._seconds(*self._setting)

    def _seconds(self, batch, threads):
        from vdna.vdnas import get_vdna
        self._torch.set_num_threads(threads)
        self._extractor.extraction_settings.batch_size = batch
        dna = get_vdna("histogram-1000")
        settings = self._data_settings(source=self._files[:batch], shuffle_files=False)
        begin = time.perf_counter()
        dna.fill_vdna(self._extractor, settings)
        return (time.perf_counter() - begin) / batch


def main():
    import torch
    name, height, width, *files = sys.argv[1:]
    Package(torch, name, (int(height), int(width)), [Path(file) for file in files], (1,))
    print(1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


if __name__ == "__main__":
    main()
