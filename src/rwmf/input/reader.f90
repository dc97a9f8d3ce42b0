!> From namelist text to a validated case.
module rwmf_input_reader
   use rwmf_core_error, only: add_context, err_input, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_input_group_values, only: entry_of, get_list, get_real, get_text, group_of, has_group, &
      has_key, integer_of, logical_of, real_of, text_of
   use rwmf_input_namelist, only: group_t, parse_namelist
   use rwmf_input_record_reader, only: read_record
   use rwmf_input_rules_scene, only: check_rules
   use rwmf_input_schema_check, only: check_groups
   use rwmf_problem_case, only: cable_t, case_t, damper_t, frame_t, fuse_t, impact_t, inerter_t, &
      initial_t, link_t, motion_spec_t, output_t, record_source_t, spectrum_spec_t, wall_t
   use rwmf_problem_equivalent_frame, only: set_equivalent_frame
   use rwmf_problem_record, only: record_t
   use rwmf_text_file, only: read_file
   use rwmf_text_strings, only: integer_to_text, real_to_text, shown
   implicit none
   private

   public :: read_case_file, read_case_text

contains

   !> Read and validate a case file, the record that it names included.
   !>
   !> Errors: the file cannot be read, and those of `read_case_text`; messages begin with the path.
   subroutine read_case_file(path, case, error)
      character(*), intent(in) :: path
      !! a relative path in the file is resolved against its folder
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: text

      !$omp critical (rwmf_text)
      call read_file(path, text, error)
      if (.not. allocated(error)) then
         call parse_case(text, path(:index(path, '/', back=.true.)), case, error)
      end if
      if (allocated(error)) call add_context(error, path)
      !$omp end critical (rwmf_text)
   end subroutine read_case_file

   !> Read and validate a case, the record that it names included.
   !>
   !> One thread at a time: gfortran keeps the length of every text that a function returns in a
   !> static variable, so that two threads at once could read each other's lengths.
   !>
   !> Errors: text that is not a namelist, unknown or repeated groups and keys, values that are not
   !> allowed, groups that contradict each other, a record that is missing or damaged.
   subroutine read_case_text(text, folder, case, error)
      character(*), intent(in) :: text
      !! namelist text
      character(*), intent(in) :: folder
      !! what a relative path in the text starts from; '' is the current folder
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error

      !$omp critical (rwmf_text)
      call parse_case(text, folder, case, error)
      !$omp end critical (rwmf_text)
   end subroutine read_case_text

   subroutine parse_case(text, folder, case, error)
      character(*), intent(in) :: text
      character(*), intent(in) :: folder
      type(case_t), intent(out) :: case
      type(error_t), allocatable, intent(out) :: error
      type(group_t), allocatable :: groups(:)

      call parse_namelist(text, groups, error)
      if (.not. allocated(error)) call check_groups(groups, error)
      if (.not. allocated(error)) call check_rules(groups, error)
      if (allocated(error)) return
      case%text = text
      call fill_structure(groups, case)
      call fill_run(groups, case)
      if (has_group(groups, 'storeys')) call fill_storeys(groups, case, error)
      if (allocated(error)) return
      if (has_group(groups, 'motion')) then
         allocate (case%motion)
         call fill_motion(groups, case%motion)
         if (case%motion%kind == 'record') then
            call add_record(groups, 'motion', folder, case%motion, case%record, case, error)
         end if
      end if
      if (allocated(error) .or. .not. has_group(groups, 'vertical')) return
      allocate (case%vertical)
      call get_real(groups, 'vertical', 'ratio', case%vertical%ratio)
      call fill_source(groups, 'vertical', case%vertical)
      if (allocated(case%vertical%file)) then
         call add_record(groups, 'vertical', folder, case%vertical, case%vertical_record, case, &
            error)
      end if
   end subroutine parse_case

   !> Wall, frame, cable, impact and initial state.
   subroutine fill_structure(groups, case)
      type(group_t), intent(in) :: groups(:)
      type(case_t), intent(inout) :: case

      if (has_group(groups, 'wall')) then
         case%wall = wall_t(real_of(groups, 'wall', 'h'), real_of(groups, 'wall', 'b'), &
            base=text_of(groups, 'wall', 'base'))
         call get_real(groups, 'wall', 'm_w', case%wall%m_w)
      end if
      if (has_group(groups, 'frame')) then
         case%frame = frame_t(xi_s=real_of(groups, 'frame', 'xi_s'))
         call get_real(groups, 'frame', 'T_s', case%frame%T_s)
         call get_real(groups, 'frame', 'gamma', case%frame%gamma)
      end if
      if (has_group(groups, 'link')) case%link = link_t(real_of(groups, 'link', 'L'))
      if (has_group(groups, 'damper')) then
         case%damper = damper_t(real_of(groups, 'damper', 'c_over_m_w'))
      end if
      if (has_group(groups, 'fuse')) then
         case%fuse = fuse_t(real_of(groups, 'fuse', 'eta_y'), real_of(groups, 'fuse', 'stroke_y'), &
            real_of(groups, 'fuse', 'hardening'))
      end if
      if (has_group(groups, 'yielding')) then
         allocate (case%yielding)
         call get_real(groups, 'yielding', 'u_y', case%yielding%u_y)
         call get_real(groups, 'yielding', 'f_y_over_m_s_g', case%yielding%f_y_over_m_s_g)
         call get_list(groups, 'yielding', 'storey_u_y', case%yielding%storey_u_y)
         case%yielding%hardening = real_of(groups, 'yielding', 'hardening')
         case%yielding%law = text_of(groups, 'yielding', 'law')
         case%yielding%exponent = real_of(groups, 'yielding', 'exponent')
         case%yielding%beta = real_of(groups, 'yielding', 'beta')
      end if
      if (has_group(groups, 'inerter')) then
         case%inerter = inerter_t(real_of(groups, 'inerter', 'inertance_over_m_w'))
      end if
      if (has_group(groups, 'cable')) then
         case%cable = cable_t(real_of(groups, 'cable', 'eta_0'), &
            real_of(groups, 'cable', 'eta_alpha'))
         ! not in the constructor, where gfortran 12 loses the memory of the function's result
         case%cable%law = text_of(groups, 'cable', 'law')
         case%cable%hardening = real_of(groups, 'cable', 'hardening')
         call get_real(groups, 'cable', 'eta_y', case%cable%eta_y)
         call get_real(groups, 'cable', 'rupture_strain', case%cable%rupture_strain)
      end if
      if (has_group(groups, 'impact')) then
         allocate (case%impact)
         call fill_impact(groups, case%impact)
      end if
      if (has_group(groups, 'initial')) then
         case%initial = initial_t(real_of(groups, 'initial', 'theta_over_alpha'), &
            real_of(groups, 'initial', 'theta_dot'))
      end if
   end subroutine fill_structure

   !> Storeys of the frame, with their modes.
   subroutine fill_storeys(groups, case, error)
      type(group_t), intent(in) :: groups(:)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      allocate (case%storeys)
      call get_list(groups, 'storeys', 'm_over_m_w', case%storeys%frame%m)
      call get_list(groups, 'storeys', 'k_over_m_w', case%storeys%frame%k)
      call get_list(groups, 'storeys', 'height', case%storeys%frame%height)
      case%storeys%coupling = text_of(groups, 'storeys', 'coupling')
      call set_equivalent_frame(case, error)
   end subroutine fill_storeys

   !> Energy loss at impact: the equations use e, the case may give r.
   subroutine fill_impact(groups, impact)
      type(group_t), intent(in) :: groups(:)
      type(impact_t), intent(out) :: impact

      impact%rule = text_of(groups, 'impact', 'rule')
      impact%given_as_r = has_key(groups, 'impact', 'r')
      if (impact%given_as_r) then
         impact%e = sqrt(real_of(groups, 'impact', 'r'))
      else
         call get_real(groups, 'impact', 'e', impact%e)
      end if
      call get_list(groups, 'impact', 'table_theta_dot', impact%table_theta_dot)
      call get_list(groups, 'impact', 'table_e', impact%table_e)
   end subroutine fill_impact

   !> Model, solver, output and spectrum.
   subroutine fill_run(groups, case)
      type(group_t), intent(in) :: groups(:)
      type(case_t), intent(inout) :: case

      case%model%formulation = text_of(groups, 'model', 'formulation')
      case%model%g = real_of(groups, 'model', 'g')
      case%model%overturning_angle = real_of(groups, 'model', 'overturning_angle')
      case%solver%method = text_of(groups, 'solver', 'method')
      case%solver%rtol = real_of(groups, 'solver', 'rtol')
      case%solver%max_steps = integer_of(groups, 'solver', 'max_steps')
      case%solver%verify = logical_of(groups, 'solver', 'verify')
      call get_real(groups, 'solver', 'accuracy', case%solver%accuracy)
      ! A multistep method cannot deliver every accuracy; a one-step method of order 8 can.
      if (allocated(case%solver%accuracy) .and. .not. has_key(groups, 'solver', 'method')) then
         case%solver%method = 'dop853'
      end if
      call get_real(groups, 'solver', 'atol', case%solver%atol)
      call get_real(groups, 'solver', 't_end', case%solver%t_end)
      if (has_group(groups, 'output')) then
         case%output = output_t(energy=logical_of(groups, 'output', 'energy'), &
            reactions=logical_of(groups, 'output', 'reactions'))
         call get_real(groups, 'output', 'friction_limit', case%output%friction_limit)
         call get_real(groups, 'output', 'dt', case%output%dt)
      end if
      if (has_group(groups, 'spectrum')) then
         allocate (case%spectrum)
         call fill_spectrum(groups, case%spectrum)
      end if
   end subroutine fill_run

   !> Periods, one by one or as a grid, mass ratios and widths.
   subroutine fill_spectrum(groups, spectrum)
      type(group_t), intent(in) :: groups(:)
      type(spectrum_spec_t), intent(out) :: spectrum

      call get_list(groups, 'spectrum', 'gamma', spectrum%gamma)
      call get_list(groups, 'spectrum', 'b', spectrum%b)
      call get_list(groups, 'spectrum', 'T_s', spectrum%T_s)
      if (allocated(spectrum%T_s)) return
      call get_real(groups, 'spectrum', 'T_s_min', spectrum%T_s_min)
      call get_real(groups, 'spectrum', 'T_s_max', spectrum%T_s_max)
      spectrum%n = integer_of(groups, 'spectrum', 'n')
      spectrum%spacing = text_of(groups, 'spectrum', 'spacing')
   end subroutine fill_spectrum

   !> What the case says about the motion; the record itself is read by `add_record`.
   subroutine fill_motion(groups, motion)
      type(group_t), intent(in) :: groups(:)
      type(motion_spec_t), intent(out) :: motion

      motion%kind = text_of(groups, 'motion', 'kind')
      motion%cycles = real_of(groups, 'motion', 'cycles')
      motion%n_pulses = integer_of(groups, 'motion', 'n_pulses')
      motion%nu = real_of(groups, 'motion', 'nu')
      motion%t_0 = real_of(groups, 'motion', 't_0')
      call get_real(groups, 'motion', 'a_max_g', motion%a_max_g)
      call get_real(groups, 'motion', 'v_p', motion%v_p)
      call get_real(groups, 'motion', 'omega_p', motion%omega_p)
      call get_real(groups, 'motion', 'T_p', motion%T_p)
      call get_real(groups, 'motion', 'gamma_p', motion%gamma_p)
      call fill_source(groups, 'motion', motion)
   end subroutine fill_motion

   !> Where the record of a group comes from.
   subroutine fill_source(groups, group, source)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      class(record_source_t), intent(inout) :: source

      source%scale = real_of(groups, group, 'scale')
      call get_real(groups, group, 'dt', source%dt)
      call get_text(groups, group, 'file', source%file)
      call get_text(groups, group, 'unit', source%unit)
   end subroutine fill_source

   !> Read the record of a group. The longest record ends the simulation unless the case says when.
   subroutine add_record(groups, group, folder, source, record, case, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: folder
      class(record_source_t), intent(inout) :: source
      type(record_t), allocatable, intent(out) :: record
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      integer :: at

      source%path = resolved(folder, source%file)
      allocate (record)
      ! what is not given is unallocated and arrives as an absent argument
      call read_record(source%path, source%dt, source%unit, source%scale, case%model%g, record, &
         error)
      if (.not. allocated(error) .and. .not. has_key(groups, 'solver', 't_end')) then
         call check_last_sample(record%t(record%n), case, error)
      end if
      if (.not. allocated(error)) return
      if (source%path /= source%file) call add_context(error, source%path)
      at = group_of(groups, group)
      associate (entry => groups(at)%entries(entry_of(groups(at), 'file')))
         call add_context(error, '&'//group//": file = '"//shown(source%file)//"' (line " &
            //integer_to_text(entry%line)//')')
      end associate
   end subroutine add_record

   !> A simulation cannot end before it starts.
   subroutine check_last_sample(t_last, case, error)
      real(wp), intent(in) :: t_last
      !! [s]
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error

      if (allocated(case%solver%t_end)) then
         case%solver%t_end = max(case%solver%t_end, t_last)
         return
      end if
      case%solver%t_end = t_last
      if (t_last >= 0) return
      call fail(error, err_input, 'the record ends at '//real_to_text(t_last) &
         //' s, before t = 0: &solver t_end must be given')
   end subroutine check_last_sample

   !> A path of the case, seen from the current folder.
   pure function resolved(folder, name) result(path)
      character(*), intent(in) :: folder
      character(*), intent(in) :: name
      character(:), allocatable :: path

      if (len(folder) == 0 .or. index(name, '/') == 1) then
         path = name
      else if (folder(len(folder):) == '/') then
         path = folder//name
      else
         path = folder//'/'//name
      end if
   end function resolved

end module rwmf_input_reader
