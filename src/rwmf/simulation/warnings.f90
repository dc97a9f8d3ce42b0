!> Warnings about a case or a run: unusual input, and behaviour outside the model.
module rwmf_simulation_warnings
   use rwmf_core_kinds, only: wp
   use rwmf_model_impact_rule, only: balanced_restitution, mass_ratio, restitution
   use rwmf_motion_ground_motion, only: lowest_vertical, motion_t
   use rwmf_problem_case, only: case_t, has_floors, has_numbers, numbers_of
   use rwmf_problem_record, only: record_source_t, record_t
   use rwmf_problem_usual_ranges, only: list_unusual, unusual_record, unusual_text
   use rwmf_simulation_state_result, only: add_warning, result_t
   use rwmf_text_strings, only: real_to_text, shown
   implicit none
   private

   public :: list_case_warnings, warn_of_chatter, warn_of_grazing, warn_of_reactions
   public :: warn_of_short_history, warn_of_toe

contains

   !> Warn of a pivot that lifts or slides, which the equation of motion does not include.
   subroutine warn_of_reactions(result)
      type(result_t), intent(inout) :: result

      associate (reactions => result%reactions)
         if (.not. allocated(reactions%pivot_lifts)) return
         if (reactions%pivot_lifts) then
            call add_warning(result, 'the pivot reaction falls to N/(m_w g) = ' &
               //trim(real_to_text(reactions%normal_min))//' at t = ' &
               //trim(real_to_text(reactions%t_normal_min)) &
               //' s: the wall would leave the ground, which the model does not follow')
         end if
         if (allocated(reactions%t_exceeded)) then
            call add_warning(result, 'the friction demand |H|/N exceeds the friction_limit from ' &
               //'t = '//trim(real_to_text(reactions%t_exceeded)) &
               //' s: the wall would slide, which the model does not follow')
         end if
      end associate
   end subroutine warn_of_reactions

   !> Warn of a toe stress beyond the linear range of the concrete.
   subroutine warn_of_toe(case, result)
      type(case_t), intent(in) :: case
      type(result_t), intent(inout) :: result
      real(wp), parameter :: linear = 0.6_wp
      !! end of the linear range, over the strength [-]

      if (.not. (has_numbers(case, 'base_section') .and. allocated(result%envelopes))) return
      associate (numbers => numbers_of(case, 'base_section'), &
                 stress => result%envelopes%toe_stress_max)
         if (.not. stress > linear*numbers(3)) return
         if (stress < numbers(3)) then
            call add_warning(result, 'the toe stress reaches '//trim(real_to_text(stress)) &
               //' Pa: above 0.6 f_c concrete strains more than stress/E')
         else
            call add_warning(result, 'the toe crushes: its stress is f_c from there on, its ' &
               //'strain follows the settlement; the motion remains that of rigid corners')
         end if
      end associate
   end subroutine warn_of_toe

   !> Warn if numerical errors may decide on contact between wall and base.
   subroutine warn_of_grazing(result)
      type(result_t), intent(inout) :: result

      if (.not. allocated(result%t_grazing)) return
      call add_warning(result, 'at t = '//trim(real_to_text(result%t_grazing)) &
         //' s the wall turns back on its base or hardly above it: what follows may depend ' &
         //'on the tolerance; &solver verify = .true. shows how much')
   end subroutine warn_of_grazing

   !> Warn of averaged bounces, after which the phase of the flights is unknown.
   subroutine warn_of_chatter(result)
      type(result_t), intent(inout) :: result

      if (.not. allocated(result%t_chatter)) return
      call add_warning(result, 'from t = '//trim(real_to_text(result%t_chatter)) &
         //' s on, bounces below the resolution of rtol are averaged or, beside moving floors, ' &
         //'left out (e near 1): the instants of later lift-offs are not those of single bounces')
   end subroutine warn_of_chatter

   !> Warn of a history that ends early with the motion.
   subroutine warn_of_short_history(t_end, result)
      real(wp), intent(in) :: t_end
      !! requested end of the history [s]
      type(result_t), intent(inout) :: result

      if (.not. (allocated(result%history) .and. result%t_end < t_end)) return
      call add_warning(result, 'the history ends at t = '//trim(real_to_text(result%t_end)) &
         //' s, when '//trim(merge('the wall overturned', 'the frame collapsed', &
         result%overturned)))
   end subroutine warn_of_short_history

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
         if (any(comes_from_landings(keys))) call add_line('forces near the base come from the ' &
            //'shocks of landings: base shear, lowest links and lowest floors depend on the ' &
            //'number of modes, the stiffness of the links, shear and damping', lines)
      else if (has_floors(case) .and. any(depends_on_bending(keys))) then
         call add_line('the wall is rigid: accelerations of linked floors, link forces, and ' &
            //'shear and moment in the wall are 1.4 to 3.6 times too small; &bending gives them', &
            lines)
      end if
      if (case%wall%base == 'pinned') return
      gamma = [mass_ratio(case)]
      b = [case%wall%b]
      if (in_grid) then
         if (allocated(case%spectrum%gamma)) gamma = case%spectrum%gamma
         if (allocated(case%spectrum%b)) b = case%spectrum%b
      end if
      call warn_of_weight(case, motion, lines)
      call warn_of_fuses(case, lines)
      call warn_of_impacts(case, gamma, atan2(b, case%wall%h), lines)
      call add_line(broken_laws(case, gamma, atan2(b, case%wall%h)), lines)
      if (.not. allocated(case%cable)) return
      if (case%model%formulation == 'published' .and. &
         abs(case%cable%eta_alpha - case%cable%eta_0) > 0) then
         call add_line('published: for theta < 0 the cable force of Eq. (1) falls ' &
            //'with rocking (eta_alpha /= eta_0); the other formulations use |theta|', lines)
      end if
   end subroutine list_case_warnings

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

   !> Warn of a vertical motion that exceeds weight and cable force: the pivot would lift.
   subroutine warn_of_weight(case, motion, lines)
      type(case_t), intent(in) :: case
      !! case with a rocking wall
      type(motion_t), intent(in) :: motion
      character(256), allocatable, intent(inout) :: lines(:)
      real(wp) :: lowest
      !! [m/s2]

      if (.not. allocated(case%upward)) return
      lowest = lowest_vertical(motion, case%solver%t_end)
      if (case%model%g*(1 + prestress(case)) + lowest > 0) return
      call add_line('v_g'''' falls to '//trim(real_to_text(lowest)) &
         //' m/s2, which takes all of weight and cable force: a pivot that lifts is not followed', &
         lines)
   end subroutine warn_of_weight

   !> Warn of fuses that may hold the wall up after yielding in tension.
   subroutine warn_of_fuses(case, lines)
      type(case_t), intent(in) :: case
      !! case with a rocking wall
      character(256), allocatable, intent(inout) :: lines(:)

      if (.not. allocated(case%fuse)) return
      associate (eta_y => case%fuse%eta_y, eta_0 => prestress(case))
         if (2*eta_y <= 1 + eta_0) return
         call add_line('2 eta_y = '//trim(real_to_text(2*eta_y))//' of &fuse exceeds 1 + eta_0 = ' &
            //trim(real_to_text(1 + eta_0)) &
            //', weight and prestress: the wall need not come down again', lines)
      end associate
   end subroutine warn_of_fuses

   !> Prestress of the cable over m_w g, 0 without a cable [-].
   pure real(wp) function prestress(case)
      type(case_t), intent(in) :: case

      prestress = 0
      if (allocated(case%cable)) prestress = case%cable%eta_0
   end function prestress

   !> Warn of velocity factors that are zero or exceed the bound of the momentum balance.
   !>
   !> For several mass ratios and slendernesses, report the largest excess.
   subroutine warn_of_impacts(case, gamma, alpha, lines)
      type(case_t), intent(in) :: case
      !! case with a rocking wall
      real(wp), intent(in) :: gamma(:)
      real(wp), intent(in) :: alpha(:)
      !! [rad]
      character(256), allocatable, intent(inout) :: lines(:)
      type(case_t) :: one
      real(wp) :: e, e_max, most(2)
      logical :: is_dead
      integer :: i, j

      one%structure_t = case%structure_t
      most = 0
      is_dead = .false.
      do i = 1, size(gamma)
         if (allocated(one%frame)) one%frame%gamma = gamma(i)
         do j = 1, size(alpha)
            e = restitution(one, alpha(j))
            e_max = balanced_restitution(one, alpha(j))
            if (e - e_max > most(1) - most(2)) most = [e, e_max]
            is_dead = is_dead .or. e <= 0
         end do
      end do
      if (is_dead .and. any(case%impact%rule == [character(7) :: 'housner', 'coupled'])) then
         call add_line('the momentum balance leaves no velocity at impact for so squat a wall: ' &
            //'e = 0', lines)
      end if
      if (most(1) > most(2)) call add_line('e = '//trim(real_to_text(most(1))) &
         //' exceeds e_max = '//trim(real_to_text(most(2))) &
         //', the most that the momentum balance of wall and frame allows', lines)
   end subroutine warn_of_impacts

   !> List the conservation laws that the input of a case violates: energy, angular momentum.
   !>
   !> This applies to a rocking wall with a frame that has mass. For theta < 0, `published` gives
   !> the frame's force a lever arm that differs from that of its displacement. A velocity factor
   !> below the momentum balance removes more velocity than the contact at the new corner can: it
   !> damps the frame. `warn_of_impacts` reports a larger factor.
   pure function broken_laws(case, gamma, alpha) result(text)
      type(case_t), intent(in) :: case
      !! case with a rocking wall
      real(wp), intent(in) :: gamma(:)
      !! mass ratios [-]
      real(wp), intent(in) :: alpha(:)
      !! slendernesses [rad]
      character(256) :: text
      !! one line; '' if no law is violated
      type(case_t) :: one
      logical :: is_broken(2)
      !! energy, angular momentum
      integer :: i, j

      text = ''
      if (.not. allocated(case%frame)) return
      one%structure_t = case%structure_t
      is_broken = [case%model%formulation == 'published' .and. any(gamma > 0), .false.]
      do i = 1, size(gamma)
         one%frame%gamma = gamma(i)
         do j = 1, size(alpha)
            is_broken(2) = is_broken(2) .or. loses_momentum(one, alpha(j))
         end do
      end do
      if (.not. any(is_broken)) return
      text = 'not conserved:'
      if (is_broken(1)) text = trim(text)//" energy while theta < 0 (formulation 'published')"
      if (all(is_broken)) text = trim(text)//','
      if (is_broken(2)) text = trim(text)//' angular momentum of wall and frame at impact ' &
         //'(e < e_max)'
   end function broken_laws

   !> Return whether an impact removes more velocity than the momentum balance of wall and frame.
   pure logical function loses_momentum(case, alpha)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: alpha
      !! slenderness [rad]

      loses_momentum = case%impact%rule /= 'coupled' .and. mass_ratio(case) > 0 &
         .and. restitution(case, alpha) < balanced_restitution(case, alpha)
   end function loses_momentum

end module rwmf_simulation_warnings
