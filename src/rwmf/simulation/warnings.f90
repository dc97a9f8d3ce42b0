!> Warnings about a case or a run: unusual input, and behaviour outside the model.
module rwmf_simulation_warnings
   use rwmf_core_kinds, only: wp
   use rwmf_model_impact_rule, only: balanced_restitution, impact_law, mass_ratio
   use rwmf_model_restitution, only: restitution_t
   use rwmf_motion_ground_motion, only: lowest_vertical, motion_t
   use rwmf_problem_case, only: case_t, has_floors, has_numbers, numbers_of
   use rwmf_problem_group_values, only: group_values_t, has_key, real_of
   use rwmf_problem_quantity_table, only: id
   use rwmf_problem_quantity_values, only: value_of
   use rwmf_problem_record, only: record_source_t, record_t
   use rwmf_problem_usual_ranges, only: list_unusual, unusual_record, unusual_text
   use rwmf_simulation_state_result, only: add_warning, result_t
   use rwmf_text_strings, only: real_to_text, rounded_text, shown
   implicit none
   private

   public :: list_case_warnings, warn_of_motion, warn_of_reactions, warn_of_toe

contains

   !> Warn of a pivot that lifts or slides, which the equation of motion does not include.
   subroutine warn_of_reactions(result)
      type(result_t), intent(inout) :: result

      if (value_of(result%values, id%pivot_lifts, 1) > 0) call add_warning(result, &
         'the pivot reaction falls to N/(m_w g) = '//trim(rounded_text( &
         value_of(result%values, id%pivot_normal_min_over_m_w_g, 1))) &
         //' at t = '//trim(rounded_text(value_of(result%values, id%t_pivot_normal_min_s, 1))) &
         //' s: the wall would leave the ground, which the model does not follow')
      if (value_of(result%values, id%friction_exceeded, 1) > 0) call add_warning(result, &
         'the friction demand |H|/N, or that of an impact, exceeds the friction_limit from t = ' &
         //trim(rounded_text(value_of(result%values, id%t_friction_exceeded_s, 1))) &
         //' s: the wall would slide, which the model does not follow')
   end subroutine warn_of_reactions

   !> Warn of a toe stress beyond the linear range of the concrete.
   subroutine warn_of_toe(case, result)
      type(case_t), intent(in) :: case
      type(result_t), intent(inout) :: result
      real(wp), parameter :: linear = 0.6_wp
      !! end of the linear range, over the strength [-]

      if (.not. has_numbers(case, 'base_section')) return
      associate (numbers => numbers_of(case, 'base_section'), &
                 stress => value_of(result%values, id%toe_stress_max_Pa, 1))
         if (.not. stress > linear*numbers(3)) return
         if (stress < numbers(3)) then
            call add_warning(result, 'the toe stress reaches '//trim(rounded_text(stress)) &
               //' Pa: above 0.6 f_c concrete strains more than stress/E')
         else
            call add_warning(result, 'the toe crushes: its stress is f_c from there on, its ' &
               //'strain follows the settlement; the motion remains that of rigid corners')
         end if
      end associate
   end subroutine warn_of_toe

   !> Warn if numerical errors may decide on contact between wall and base, of averaged bounces,
   !> after which the phase of the flights is unknown, and of a history that ends early.
   subroutine warn_of_motion(t_end, result)
      real(wp), intent(in) :: t_end
      !! requested end of the history [s]
      type(result_t), intent(inout) :: result

      if (result%t_grazing >= 0) call add_warning(result, 'at t = ' &
         //trim(rounded_text(result%t_grazing)) &
         //' s the wall turns back on its base or hardly above it: what follows may depend ' &
         //'on the tolerance; &solver verify = .true. shows how much')
      if (result%t_chatter >= 0) call add_warning(result, 'from t = ' &
         //trim(rounded_text(result%t_chatter)) &
         //' s on, bounces below the resolution of rtol are averaged or, beside moving floors, ' &
         //'left out (e near 1): the instants of later lift-offs are not those of single bounces')
      if (allocated(result%history) .and. result%t_end < t_end) call add_warning(result, &
         'the history ends at t = '//trim(rounded_text(result%t_end))//' s, when ' &
         //trim(merge('the wall overturned', 'the frame collapsed', result%overturned)))
   end subroutine warn_of_motion

   !> List the warnings about a case before its simulation, one line each.
   subroutine list_case_warnings(case, motion, in_grid, keys, lines)
      type(case_t), intent(in) :: case
      type(motion_t), intent(in) :: motion
      logical, intent(in) :: in_grid
      !! check all points of its `&spectrum`; otherwise only the single run of the case
      character(*), intent(in) :: keys(:)
      !! (quantities) keys of the reported quantities
      character(256), allocatable, intent(out) :: lines(:)
      !! (warnings)
      real(wp), allocatable :: gamma(:), b(:)
      real(wp) :: lowest
      !! [m/s2]

      call list_unusual(case%values, lines)
      if (allocated(case%record)) call warn_of_record(case%record, &
         case%motion%record_source_t, case%model%g, lines)
      if (allocated(case%upward_record)) call warn_of_record(case%upward_record, &
         case%upward%record_source_t, case%model%g, lines)
      if (has_floors(case) .and. size(lines) == 0) then
         if (allocated(case%frame%T_s)) call add_line(unusual_text(case%values, 'frame', 'T_s', &
            case%frame%T_s), lines)
      end if
      if (.not. allocated(case%wall)) return
      if (has_numbers(case, 'bending')) then
         call warn_of_landings(case, keys, lines)
      else if (has_floors(case) .and. any(depends_on_bending(keys))) then
         call add_line('the wall is rigid: accelerations of linked floors, link forces, and ' &
            //'shear and moment in the wall are 1.4 to 3.6 times too small; &bending gives them', &
            lines)
      end if
      ! the other warnings are about impacts on rigid corners
      if (case%wall%base == 'pinned' .or. allocated(case%compliant_base)) return
      gamma = [mass_ratio(case)]
      b = [case%wall%b]
      if (in_grid) then
         if (allocated(case%spectrum%gamma)) gamma = case%spectrum%gamma
         if (allocated(case%spectrum%b)) b = case%spectrum%b
      end if
      if (allocated(case%upward)) then
         lowest = lowest_vertical(motion, case%solver%t_end)
         if (.not. case%model%g*(1 + prestress(case)) + lowest > 0) call add_line( &
            'v_g'''' falls to '//trim(rounded_text(lowest))//' m/s2, which takes all of weight ' &
            //'and cable force: a pivot that lifts is not followed', lines)
      end if
      call warn_of_fuses(case, lines)
      call warn_of_impacts(case, gamma, atan2(b, case%wall%h), lines)
      call warn_of_soil(case%values, lines)
      ! for theta < 0, `published` gives the frame's force another lever arm than its displacement
      if (allocated(case%frame) .and. case%model%formulation == 'published' &
          .and. any(gamma > 0)) then
         call add_line("not conserved: energy while theta < 0 (formulation 'published')", lines)
      end if
      if (.not. allocated(case%cable)) return
      if (case%model%formulation == 'published' .and. &
         any(abs(case%cable%eta_alpha - case%cable%eta_0) > 0)) then
         call add_line('published: for theta < 0 the cable force of Eq. (1) falls ' &
            //'with rocking (eta_alpha /= eta_0); the other formulations use |theta|', lines)
      end if
   end subroutine list_case_warnings

   !> Warn of forces that grow with the number of modes.
   !>
   !> Springs between floors and wall limit the shock of a landing in links and floors, shear
   !> deformation that at the base.
   pure subroutine warn_of_landings(case, keys, lines)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: keys(:)
      !! (quantities) keys of the reported quantities
      character(256), allocatable, intent(inout) :: lines(:)
      logical :: has_springs

      has_springs = .false.
      if (has_floors(case)) has_springs = case%frame%coupling == 'springs'
      if (.not. has_springs) then
         if (any(comes_from_landings(keys))) call add_line('forces near the base come from the ' &
            //'shocks of landings: base shear, lowest links and lowest floors depend on the ' &
            //"number of modes; coupling = 'springs' and &bending nu limit them", lines)
      else if (.not. has_key(case%values, 'bending', 'nu')) then
         if (any(index(keys, 'base_shear') == 1)) call add_line('the base shear comes from the ' &
            //'shocks of landings and grows with the number of modes; &bending nu limits it', &
            lines)
      end if
   end subroutine warn_of_landings

   !> Warn of a recorded motion that is no earthquake in its units.
   subroutine warn_of_record(record, source, g, lines)
      type(record_t), intent(in) :: record
      type(record_source_t), intent(in) :: source
      real(wp), intent(in) :: g
      !! [m/s2]
      character(256), allocatable, intent(inout) :: lines(:)
      real(wp) :: interval
      !! [s]
      character(256) :: text

      interval = record%t_last/(record%n - 1)
      if (allocated(record%dt)) interval = record%dt
      text = unusual_record(record%peak/g, interval, record%t_last)
      if (text == '' .or. .not. abs(source%scale) > 0) return
      if (allocated(source%file)) then
         call add_line(shown(source%file)//': '//trim(text), lines)
      else
         call add_line('record: '//trim(text), lines)
      end if
   end subroutine warn_of_record

   !> Add a line unless it is empty.
   pure subroutine add_line(line, lines)
      character(*), intent(in) :: line
      character(256), allocatable, intent(inout) :: lines(:)

      if (line /= '') lines = [character(256) :: lines, line]
   end subroutine add_line

   !> Return whether a rigid wall leads to an underestimate of a quantity.
   elemental logical function depends_on_bending(key)
      character(*), intent(in) :: key
      !! key of a quantity, with the number of a floor or '{i}'

      depends_on_bending = (index(key, 'floor_') == 1 .and. index(key, 'acceleration') > 0) &
         .or. index(key, 'wall_shear') == 1 .or. index(key, 'wall_moment') == 1 &
         .or. index(key, 'link_') == 1
   end function depends_on_bending

   !> Return whether a quantity of a bending wall does not converge with the number of modes.
   elemental logical function comes_from_landings(key)
      character(*), intent(in) :: key
      !! key of a quantity, with the number of a floor or '{i}'

      comes_from_landings = index(key, 'wall_shear') == 1 .or. index(key, 'link_') == 1 &
         .or. (index(key, 'floor_') == 1 .and. index(key, 'acceleration') > 0) &
         .or. index(key, 'pivot') == 1 .or. index(key, 'base_shear') == 1
   end function comes_from_landings

   !> Warn of fuses that may hold the wall up after yielding in tension.
   subroutine warn_of_fuses(case, lines)
      type(case_t), intent(in) :: case
      !! case with a rocking wall
      character(256), allocatable, intent(inout) :: lines(:)
      character(25) :: texts(2)

      if (.not. allocated(case%fuse)) return
      associate (push => sum(case%fuse%eta_y), eta_0 => prestress(case))
         if (push <= 1 + eta_0) return
         texts = distinct_texts(push, 1 + eta_0)
         call add_line('2 eta_y = '//trim(texts(1))//' of &fuse exceeds 1 + eta_0 = ' &
            //trim(texts(2)) &
            //', weight and prestress: the wall need not come down again', lines)
      end associate
   end subroutine warn_of_fuses

   !> Prestress of the cable over m_w g, 0 without a cable [-].
   pure real(wp) function prestress(case)
      type(case_t), intent(in) :: case

      prestress = 0
      if (allocated(case%cable)) prestress = sum(case%cable%eta_0)
   end function prestress

   !> Warn of velocity factors that are zero, that need an impulse outside the base, or that let the
   !> base slide.
   !>
   !> An impulse at the distance x from the new corner, inside the base, gives
   !> e = e_max + b (1 + e) x/inertia. The inertia of wall, frame and inerters is
   !> 2 b**2/(1 - e_max).
   !> Of several mass ratios and slendernesses, report the impulse that is farthest outside.
   subroutine warn_of_impacts(case, gamma, alpha, lines)
      type(case_t), intent(in) :: case
      !! case with a rocking wall
      real(wp), intent(in) :: gamma(:)
      real(wp), intent(in) :: alpha(:)
      !! [rad]
      character(256), allocatable, intent(inout) :: lines(:)
      real(wp), parameter :: steep = 0.5_wp*(1 - 1.0e-12_wp), lossy = 0.8_wp
      !! tan(alpha) and e at which the impulse of an impact exceeds usual friction [-]
      real(wp), parameter :: round_off = 1.0e-6_wp
      !! smallest distance outside the base, over its width [-]
      type(case_t) :: one
      type(restitution_t) :: law
      real(wp) :: e, e_max, outside
      real(wp) :: far(3), slides(2)
      !! e, e_max and the distance outside the base over its width; tan(alpha) and e [-]
      character(25) :: texts(2)
      logical :: is_dead
      integer :: i, j

      one%structure_t = case%structure_t
      far = [0.0_wp, 0.0_wp, round_off]
      slides = 0
      is_dead = .false.
      do i = 1, size(gamma)
         if (allocated(one%frame)) one%frame%gamma = gamma(i)
         do j = 1, size(alpha)
            law = impact_law(one, alpha(j))
            e = law%e
            if (allocated(law%factor)) e = minval(law%factor)
            e_max = balanced_restitution(one, alpha(j))
            outside = (e_max - e)/(max(1 - e_max, epsilon(e))*(1 + e))
            if (outside > far(3)) far = [e, e_max, outside]
            if (tan(alpha(j)) >= steep .and. e < lossy) slides = [tan(alpha(j)), e]
            is_dead = is_dead .or. e <= 0
         end do
      end do
      if (is_dead .and. any(case%impact%rule == [character(7) :: 'housner', 'coupled'])) then
         call add_line('the momentum balance leaves no velocity at impact for so squat a wall: ' &
            //'e = 0', lines)
      end if
      if (far(3) > round_off) then
         texts = distinct_texts(far(1), far(2))
         if (texts(2) == '1.0' .and. far(2) < 1) then
            texts(2) = rounded_text(1 - far(2))
            texts(2) = '1 - '//texts(2)(:21)
         end if
         call add_line('e = '//trim(texts(1))//' is below e_max = '//trim(texts(2)) &
            //", that of &impact rule = 'coupled': the impulse would act " &
            //trim(rounded_text(far(3)))//' base widths outside the base', lines)
      end if
      if (slides(1) > 0 .and. .not. case%wall%shear_key) call add_line('tan(alpha) = ' &
         //trim(rounded_text(slides(1)))//' with e = ' &
         //trim(rounded_text(slides(2))) &
         //': a base without a shear key slides at such impacts, which the model does not follow ' &
         //'(friction_demand_impact_max)', lines)
   end subroutine warn_of_impacts

   !> Texts of two numbers that a message compares: rounded unless they would look equal.
   pure function distinct_texts(x, y) result(texts)
      real(wp), intent(in) :: x, y
      character(25) :: texts(2)

      texts = [rounded_text(x), rounded_text(y)]
      if (texts(1) == texts(2)) texts = [real_to_text(x), real_to_text(y)]
   end function distinct_texts

   !> Warn of soil on which a wall sinks instead of rocking on its corners.
   subroutine warn_of_soil(values, lines)
      type(group_values_t), intent(in) :: values
      character(256), allocatable, intent(inout) :: lines(:)
      real(wp), parameter :: softest = 1.0e4_wp
      !! [1/(m s2)]
      real(wp) :: stiffness

      if (.not. has_key(values, 'base_section', 'k')) return
      stiffness = real_of(values, 'base_section', 'k')*real_of(values, 'wall', 'thickness') &
         /real_of(values, 'wall', 'm_w')
      if (stiffness >= softest) return
      call add_line('k of &base_section times thickness/m_w = ' &
         //trim(rounded_text(stiffness))//' 1/(m s2) is below 1e4: the wall sinks ' &
         //'into such soil, and the model of a rigid base does not hold', lines)
   end subroutine warn_of_soil

end module rwmf_simulation_warnings
