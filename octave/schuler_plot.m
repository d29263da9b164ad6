function handles = schuler_plot(run, group, table)
% SCHULER_PLOT(RUN) draws the position, velocity and attitude of a run that SCHULER_LOAD has read.
% SCHULER_PLOT(RUN, GROUP, TABLE) draws one table over the time, a panel for each column with its name and unit:
%   schuler_plot(run, 'solution', 'velocity')
%   schuler_plot(run, 'innovations.gnss_position', 'innovation')
% With a table std_TABLE beside it, or `sigma` beside `innovation`, one sigma is drawn about zero for errors and innovations, about the
% values elsewhere. HANDLES are those of the axes.
%
% For Octave and MATLAB.
    if nargin < 2
        handles = [];
        for name = {'position', 'velocity', 'attitude'}
            figure();
            handles = [handles; schuler_plot(run, 'solution', name{1})];
        end
        return
    end
    data = run;
    for part = strsplit(group, '.')
        if ~isfield(data, part{1})
            error('schuler:plot', 'there is no group %s in this run; there are: %s', group, strjoin(fieldnames(data)', ', '));
        end
        data = data.(part{1});
    end
    if nargin < 3 || ~isfield(data, table)
        error('schuler:plot', 'name a table of %s: %s', group, strjoin(setdiff(fieldnames(data)', {'units', 'columns'}), ', '));
    end
    values = data.(table);
    time = data.time_s - run.origin_s;
    sigma = [];
    if isfield(data, ['std_' table])
        sigma = data.(['std_' table]);
    elseif strcmp(table, 'innovation') && isfield(data, 'sigma')
        sigma = data.sigma;
    end
    about_zero = strncmp(group, 'errors', 6) || strncmp(group, 'innovations', 11);
    units = part_of(data, 'units', table);
    names = part_of(data, 'columns', table);
    count = size(values, 2);
    handles = zeros(count, 1);
    for i = 1:count
        handles(i) = subplot(count, 1, i);
        plot(time, values(:, i));
        if isequal(size(sigma), size(values)) && ~degrees_beside_metres(data, table)
            hold('on');
            middle = values(:, i) * ~about_zero;
            plot(time, middle - sigma(:, i), 'k:', time, middle + sigma(:, i), 'k:');
            hold('off');
        end
        ylabel(label(names, units, i, table));
        grid('on');
    end
    xlabel('time, s');
    title(handles(1), strrep([group ' ' table], '_', ' '));
end

function mixed = degrees_beside_metres(data, table)
% Positions are in degrees and their sigmas in metres.
    mixed = isfield(data, 'units') && isfield(data.units, table) && isfield(data.units, ['std_' table]) ...
        && ~strcmp(data.units.(table), data.units.(['std_' table]));
end

function parts = part_of(data, kind, table)
    parts = {};
    if isfield(data, kind) && isfield(data.(kind), table)
        parts = data.(kind).(table);
        if ischar(parts)
            parts = strsplit(parts, ',');
        end
    end
end

function text = label(names, units, i, table)
    text = table;
    if numel(names) >= i
        text = names{i};
    end
    if numel(units) >= i
        text = [text ', ' units{i}];
    elseif numel(units) == 1
        text = [text ', ' units{1}];
    end
    text = strrep(text, '_', ' ');
end
