function figure_handle = servoscope_plot(result)
%SERVOSCOPE_PLOT  Draws the frequency response, measured and simulated.
%   H = servoscope_plot(R) draws the result R of servoscope_wait or
%   servoscope_result: gain and phase as measured (points), of the base model
%   (dashed) and of the model with the causes (full), and beneath by how much
%   the measurement differs from each (crosses, points), in dB and degrees.
%
%   Example:
%     print(servoscope_plot(R), 'axis.png', '-dpng');
    c = result.comparison;
    rows = excited(c);
    frequency = c.harmonic .* c.omega / (2 * pi);
    magnitudes = c.magnitude(rows);
    edges = levels(magnitudes);
    figure_handle = figure();
    names = {'gain (dB)', 'phase (deg)', 'error (dB)', 'error (deg)'};
    panels = cell(1, 4);
    for i = 1:4
        panels{i} = subplot(4, 1, i);
        set(panels{i}, 'XScale', 'log');
        hold(panels{i}, 'on');
        grid(panels{i}, 'on');
        ylabel(panels{i}, names{i});
    end
    xlabel(panels{4}, 'frequency (Hz)');
    colours = lines(numel(edges));
    for level = 1:numel(edges)
        if level < numel(edges)
            here = rows(magnitudes >= edges(level) & magnitudes < edges(level + 1));
        else
            here = rows(magnitudes >= edges(level));
        end
        [f, order] = sort(frequency(here));
        here = here(order);
        ratio = @(response) response(here) ./ c.input(here);
        decibels = @(value) 20 * log10(abs(value));
        degrees = @(value) angle(value) * 180 / pi;
        look = {'Color', colours(level, :)};
        measured = ratio(c.measured);
        reference = unwrapped(ratio(c.base));
        models = {c.base, '--', 'x'; c.extended, '-', '.'};
        for i = 1:2
            model = ratio(models{i, 1});
            if all(isnan(model))
                continue
            end
            reference = unwrapped(model);
            error_of = measured ./ model;
            plot(panels{1}, f, decibels(model), models{i, 2}, look{:});
            plot(panels{2}, f, reference, models{i, 2}, look{:});
            plot(panels{3}, f, decibels(error_of), models{i, 3}, look{:});
            plot(panels{4}, f, degrees(error_of), models{i, 3}, look{:});
        end
        turns = round((degrees(measured) - reference) / 360);
        points(level) = plot(panels{1}, f, decibels(measured), 'o', 'MarkerSize', 3, look{:});
        plot(panels{2}, f, degrees(measured) - 360 * turns, 'o', 'MarkerSize', 3, look{:});
    end
    names = arrayfun(@(edge) sprintf('magnitude %.4g', edge), edges, 'UniformOutput', false);
    legend(points, names, 'Location', 'southwest');
end

function phase = unwrapped(ratio)
    phase = unwrap(angle(ratio)) * 180 / pi;
end

function rows = excited(c)
%EXCITED  Lines that carry 99 % of the power of each input; of few, the strongest.
    kept = {};
    for experiment = unique(c.experiment)'
        lines = find(c.experiment == experiment & c.harmonic > 0 & abs(c.input) > 0);
        if isempty(lines)
            continue
        end
        [power, order] = sort(abs(c.input(lines)) .^ 2, 'descend');
        before = cumsum(power) - power;
        kept{end + 1} = lines(order(before < 0.99 * sum(power)));
    end
    if all(cellfun(@numel, kept) <= 3)
        kept = cellfun(@(lines) lines(1), kept, 'UniformOutput', false);
    end
    rows = vertcat(kept{:});
end

function edges = levels(magnitudes)
%LEVELS  Lowest magnitude of each level; within 5 % they are the same.
    edges = [];
    for magnitude = sort(magnitudes(:))'
        if isempty(edges) || magnitude > 1.05 * edges(end)
            edges(end + 1) = magnitude;
        end
    end
end
